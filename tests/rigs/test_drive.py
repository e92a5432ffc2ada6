"""Limits that fall with speed, torque lost to heat, and lags, against their equations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.rigs.test_hidden import needed_torque
from workbench.core import Excitation, SimulationError
from workbench.rigs import PERFECT, Experiment, HiddenEffect, VirtualLeg
from workbench.rigs.drive import Drive
from workbench.rigs.experiments import HOLD
from workbench.rigs.integrate import Integrator
from workbench.rigs.machine import Machine, SpeedLimit
from workbench.rigs.structure import LegStructure, leg_structure

SLOW = HiddenEffect("speed_torque_limit", "hip", parameters={"stall_torque": 6.0, "no_load_speed": 8.0})
HOT = HiddenEffect("thermal_derating", "knee", parameters={"coefficient": 0.4, "time_constant": 0.3})


def swing(torque: float = 4.0, rows: int = 1200) -> Experiment:
    t = np.arange(rows) * 1e-3
    feedforward = np.outer(np.sin(2 * np.pi * 2.0 * t), [torque, 0.5 * torque])
    return Experiment("swing", np.tile(HOLD, (rows, 1)), feedforward, Excitation("reference"))


def test_torque_stays_below_a_limit_that_falls_with_speed() -> None:
    (recording,) = VirtualLeg([SLOW], sensors=PERFECT).run([swing(12.0)])
    torque = recording.signals["torque_measured"][:, 0]
    driving = recording.velocity[:, 0] * np.sign(torque)
    most = 6.0 * np.clip(1.0 - driving / 8.0, 0.0, 1.0)
    assert np.all(np.abs(torque) <= most + 1e-12)
    assert np.mean(np.abs(torque) > most - 1e-9) > 0.1  # it is often there


@pytest.mark.parametrize(
    ("speed", "most"), [(0.0, 6.0), (4.0, 3.0), (8.0, 0.0), (9.0, 0.0), (-4.0, 6.0), (-9.0, 6.0)]
)
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_only_driving_is_limited_by_speed(speed: float, most: float, way: float) -> None:
    machine = Machine(delay=0.0)
    machine.speed_limit[0] = SpeedLimit(6.0, 8.0)
    drive = Drive(machine, 1e-3)
    drive.feel(way * speed, 0.0)
    drive.command((way * 20.0, 0.0))
    assert drive.torque == (way * most, 0.0)


@pytest.mark.parametrize("rest", [0.0, 0.4e-3])
def test_a_flywheel_runs_up_to_its_no_load_speed(rest: float) -> None:
    """J w' = min(u, stall (1 - w / no load)) in continuous time."""
    machine = Machine(delay=3e-3 + rest)
    machine.speed_limit[0] = SpeedLimit(6.0, 8.0)
    drive = Drive(machine, 1e-3)
    links = LegStructure(0.05, 0.0, 0.02, 0.0, 0.0).minus(leg_structure())
    leg = Integrator(Machine(increment=links, rotor=[0.0, 0.0], damping=[0.0, 0.0]))
    state, speeds = leg.start(0.0, 0.0), []
    for _ in range(200):
        drive.command((4.0, 0.0))
        for u1, u2, duration in drive.advance((0.0, 0.0)):
            state = leg.advance(state, u1, u2, duration)
            drive.feel(*state[1])
        speeds.append(state[1][0])
    times = np.arange(1, 201) * 1e-3
    late = 3e-3 + rest
    reference = solve_ivp(
        lambda t, w: min(4.0, 6.0 * (1 - w[0] / 8.0)) / 0.05 * (t > late),
        (0.0, 0.2),
        [0.0],
        t_eval=times,
        max_step=1e-4,
        rtol=1e-9,
    ).y[0]
    np.testing.assert_allclose(
        speeds, reference, atol=6e-3
    )  # the first piece does not know the speed to come
    np.testing.assert_allclose(speeds[100:], reference[100:], atol=1e-4)


def test_heat_takes_torque_that_the_sensor_does_not_miss() -> None:
    """gain = 1 - c y with time_constant y' = u^2 - y, against the log of an unmeasured loss."""
    (recording,) = VirtualLeg([HOT], sensors=PERFECT).run([swing()])
    measured = recording.signals["torque_measured"]
    u, filtered, gain = measured[:-1, 1], 0.0, []
    for square in u**2:  # the torque is held over a row
        start, filtered = filtered, square + (filtered - square) * np.exp(-1e-3 / 0.3)
        gain.append(1 - 0.4 * 0.5 * (start + filtered))
    needed = needed_torque(recording)
    np.testing.assert_allclose(needed[:, 1], np.array(gain) * u, atol=2e-4)
    np.testing.assert_allclose(needed[:, 0], measured[:-1, 0], atol=2e-4)
    assert min(gain) < 0.85


def test_heat_never_turns_the_torque_round() -> None:
    melting = HiddenEffect("thermal_derating", "knee", parameters={"coefficient": 5.0, "time_constant": 0.05})
    (recording,) = VirtualLeg([melting], sensors=PERFECT).run([swing()])
    assert np.isfinite(recording.position).all()


@pytest.mark.parametrize(
    "nothing",
    [
        HiddenEffect("thermal_derating", "hip", parameters={"coefficient": 0.0, "time_constant": 1.0}),
        HiddenEffect("speed_torque_limit", "hip", parameters={"stall_torque": 1e6, "no_load_speed": 1e6}),
    ],
    ids=lambda e: e.effect,
)
def test_a_limit_out_of_reach_changes_nothing(nothing: HiddenEffect) -> None:
    (recording,), (nominal,) = (
        VirtualLeg(h, sensors=PERFECT).run([swing(rows=400)]) for h in ([nothing], [])
    )
    for signal, values in nominal.signals.items():
        np.testing.assert_allclose(recording.signals[signal], values, atol=1e-10)


@pytest.mark.parametrize("effect", [SLOW, HOT])
def test_two_of_a_kind_on_one_motor_are_refused(effect: HiddenEffect) -> None:
    with pytest.raises(SimulationError, match="room for one"):
        VirtualLeg([effect, effect])
