"""Hardware driven row by row moves as the rig that records does, and drives stop when nobody speaks."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.can import Damiao, Feedback, Mit, Parameter, Ranges, Robstride, Setpoint
from workbench.core import Excitation, SimulationError
from workbench.rigs import PERFECT, HiddenEffect, LiveLeg, LiveShaft, VirtualLeg, VirtualMotor, multisine
from workbench.rigs.bench import VirtualBench

RANGES = Ranges(12.5, 30.0, 20.0, 500.0, 5.0, "label")


@pytest.mark.parametrize(
    "hidden",
    [(), (HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.25}),),
     (HiddenEffect("torque_bias", "hip", parameters={"torque": 0.3}),)],
)  # fmt: skip
def test_the_same_torque_gives_the_same_motion(hidden) -> None:
    [logged] = VirtualLeg(hidden, sensors=PERFECT).run([multisine("sum", duration=1.0, period=1.0)])
    leg = LiveLeg(hidden, sensors=PERFECT, row=1e-3)
    moved = []
    for torque in logged.signals["torque_measured"]:
        leg.command(torque)
        moved.append([look[0] for look in leg.look()])
        leg.advance()
    assert np.abs(np.array(moved) - logged.position).max() < 1e-9


def test_the_same_torque_turns_the_same_shaft() -> None:
    wanted = np.sin(np.arange(500) * 0.05)
    [logged] = VirtualBench(sensors=PERFECT).run({"a": wanted}, Excitation("random"))
    shaft, moved = LiveShaft(sensors=PERFECT, row=1e-3), []
    for torque in logged.signals["torque_measured"]:
        shaft.command(torque)
        moved.append(shaft.look()[0][0])
        shaft.advance()
    assert np.abs(np.array(moved) - logged.position[:, 0]).max() < 1e-12


def test_gains_of_a_loop_cannot_hide_in_the_hardware() -> None:
    with pytest.raises(SimulationError, match="configuration"):
        wrong = {"kp_scale": 1.1, "kd_scale": 1.0}
        LiveLeg((HiddenEffect("controller_gain_error", "hip", parameters=wrong),))


def driven(motor: VirtualMotor, until: float, begin: float = 0.0) -> list[tuple[float, float]]:
    """Time and torque of rows in which nothing is heard."""
    out = []
    for k in range(round((until - begin) / 1e-3)):
        now = begin + k * 1e-3
        motor.obey(now)
        out.append((now, motor.torque((0.0, 0.0, 0.0))))
        motor.answer((0.0, 0.0, 0.0), now, 1e-3)
    return out


@pytest.mark.parametrize("drive", [Damiao(1, 0x11, RANGES), Robstride(1, 0xFD, RANGES), Mit(1, 0x11, RANGES)])
def test_a_watchdog_stops_a_drive_that_hears_nothing(drive) -> None:
    motor = VirtualMotor("hip", drive)
    if drive.parameters:
        assert motor.parameters["watchdog"] == 0.0, "off is the factory setting"
        motor.hear(drive.write(Parameter("watchdog", 0.02)))
    else:
        motor.parameters["watchdog"] = 0.02
    motor.hear(drive.command(Setpoint(0, 0, 0, 0, 5.0)))
    assert not any(torque for _, torque in driven(motor, 0.01)), "a drive that is not enabled does not drive"
    motor.hear(drive.act("enable"))
    motor.hear(drive.command(Setpoint(0, 0, 0, 0, 5.0)))
    torques = driven(motor, 0.1, 0.01)
    last = max(now for now, torque in torques if torque)
    assert 0.028 <= last <= 0.0305 and not motor.enabled
    motor.hear(drive.act("enable"))
    driven(motor, 0.11, 0.1)
    assert not motor.enabled, "not before the fault is cleared"
    motor.hear(drive.act("clear"))
    motor.hear(drive.act("enable"))
    driven(motor, 0.12, 0.11)
    assert motor.enabled and motor.fault == 0


def test_a_drive_follows_and_says_how_warm_it_is() -> None:
    drive = Damiao(1, 0x11, RANGES)
    motor = VirtualMotor("hip", drive, sign=-1, offset=0.5)
    for frame in (drive.act("enable"), drive.command(Setpoint(1.0, 0.0, 10.0, 0.0, 0.0))):
        motor.hear(frame)
    motor.obey(0.0)
    assert motor.torque((0.5, 0.0, 0.0)) == pytest.approx(-10.0, abs=0.02)
    [said] = motor.answer((0.3, 1.0, -10.0), 0.0, 1e-3)
    told = drive.decode(said)
    assert isinstance(told, Feedback) and told.enabled
    assert told[:3] == pytest.approx((0.2, -1.0, 10.0), abs=0.01)
    for k in range(60_000):
        motor.heard = k * 1e-3
        motor.answer((0.0, 0.0, 10.0), k * 1e-3, 1e-3)
    assert 40.0 < motor.temperature < 100.0


def test_a_hot_drive_gives_up_and_says_so() -> None:
    drive = Damiao(1, 0x11, RANGES)
    motor = VirtualMotor("hip", drive)
    motor.hear(drive.act("enable"))
    motor.temperature = 120.0
    motor.obey(0.0)
    told = drive.decode(motor.answer((0.0, 0.0, 0.0), 0.0, 1e-3)[-1])
    assert isinstance(told, Feedback) and told.fault and not motor.enabled
