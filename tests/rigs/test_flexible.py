"""Compliance, backlash, a soft stand and their combinations obey Lagrange, and only friction takes energy."""

from collections.abc import Sequence

import numpy as np
import pytest

from tests.rigs.lagrange import CRANK, HELD, MOTOR1, MOTOR2, NAMES, ROW, SHANK, STAND, THIGH, Leg
from workbench.core import SimulationError
from workbench.rigs import HiddenEffect, VirtualLeg
from workbench.rigs.events import State
from workbench.rigs.hidden import install
from workbench.rigs.integrate import Integrator
from workbench.rigs.machine import ACTUATOR_DAMPING, Machine

HIP = HiddenEffect("joint_compliance", "hip", parameters={"stiffness": 200.0, "damping": 0.3})
DRIVE = HiddenEffect("joint_compliance", "knee", parameters={"stiffness": 120.0, "damping": 0.2})
PIN = HiddenEffect("joint_compliance", "knee", "joint", {"stiffness": 90.0, "damping": 0.1})
BASE = HiddenEffect("base_compliance", parameters={"stiffness": 8000.0, "damping": 15.0, "mass": 3.0})
PLAY = HiddenEffect("backlash", "knee", parameters={"gap": 0.02, "stiffness": 400.0})
DAMPED = HiddenEffect("backlash", "knee", parameters={**PLAY.parameters, "damping": 0.9})
DAHL = HiddenEffect("presliding_hysteresis", "knee", parameters={"torque": 0.3, "stiffness": 25.0})
START = (-0.5, 0.6)


def machine(*effects: HiddenEffect, damping: bool = True) -> Machine:
    made = Machine()
    if not damping:
        made.damping = [0.0, 0.0]
    for effect in effects:
        install(effect, made)
    return made


def run(
    made: Machine, torque: Sequence[float] = (0.0, 0.0), rows: int = 300, speeds: Sequence[float] = ()
) -> tuple[Integrator, list[State]]:
    leg = Integrator(made)
    q, v = leg.start(*START)
    states = [(q, list(speeds) or v)]
    for row in range(rows):
        swing = swings(row)
        states.append(leg.advance(states[-1], torque[0] * swing, torque[1] * swing, 1e-3))
    return leg, states


def swings(row: float) -> float:
    """What a torque is multiplied by, held for some rows."""
    return np.cos(2 * np.pi * 3.0 * np.floor(row / HELD + 1e-9) * HELD * ROW)


def energies(leg: Integrator, states: list[State]) -> np.ndarray:
    return np.array([leg.leg.energy(q, v) for q, v in states])


def outside(torque: Sequence[float], springs: Sequence[tuple], stand: tuple[float, float] = (0.0, 0.0)):
    """Motor torques that swing from row to row, springs (front, back, stiffness, damping, gap), the stand."""

    def total(q: np.ndarray, v: np.ndarray, t: float) -> np.ndarray:
        f = np.zeros(6)
        swing = swings(t / ROW)
        for motor, u in zip((MOTOR1, MOTOR2), torque, strict=True):
            f[motor] = u * swing - ACTUATOR_DAMPING * v[motor]
        for front, back, stiffness, damping, gap in springs:
            wind = q[front] - q[back]
            touches = not gap or abs(wind) > gap / 2
            wind = np.sign(wind) * max(0.0, abs(wind) - gap / 2)
            twist = stiffness * wind + damping * touches * (v[front] - v[back])
            f[front], f[back] = f[front] - twist, f[back] + twist
        f[STAND] -= stand[0] * q[STAND] + stand[1] * v[STAND]
        return f

    return total


CASES = {
    "rigid": ((), (), [], (0.0, 0.0)),
    "hip drive": (("motor 1",), (HIP,), [(MOTOR1, THIGH, 200.0, 0.3, 0.0)], (0.0, 0.0)),
    "knee pin": (("crank",), (PIN,), [(CRANK, SHANK, 90.0, 0.1, 0.0)], (0.0, 0.0)),
    "stand": (("stand",), (BASE,), [], (8000.0, 15.0)),
    "backlash": (("motor 2",), (PLAY,), [(MOTOR2, CRANK, 400.0, 0.0, 0.02)], (0.0, 0.0)),
    "damped backlash": (("motor 2",), (DAMPED,), [(MOTOR2, CRANK, 400.0, 0.9, 0.02)], (0.0, 0.0)),
    "all": (
        ("motor 1", "motor 2", "crank", "stand"),
        (HIP, DRIVE, PIN, BASE),
        [(MOTOR1, THIGH, 200.0, 0.3, 0.0), (MOTOR2, CRANK, 120.0, 0.2, 0.0), (CRANK, SHANK, 90.0, 0.1, 0.0)],
        (8000.0, 15.0),
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_motion_is_that_of_masses_and_jacobians(case: str) -> None:
    """Against an equation of motion written by hand and integrated tightly; torque is held row by row."""
    extra, effects, springs, stand = CASES[case]
    rows, torque = 120, (0.8, -0.5)
    free = ("thigh", "shank", *extra)
    reference = Leg(free, outside(torque, springs, stand), stand=3.0)
    leg, states = run(machine(*effects), torque, rows)
    expected = reference.integrate(np.concatenate([leg.leg.start(*START), np.zeros(len(free))]), rows)
    chosen = [NAMES[name] for name in free]
    ours = np.array([np.concatenate(state) for state in states])
    np.testing.assert_allclose(ours[:, : len(free)], expected[:, chosen], atol=3e-8)
    np.testing.assert_allclose(ours[:, len(free) :], expected[:, [6 + i for i in chosen]], atol=3e-6)


@pytest.mark.parametrize("effects", [(HIP, DRIVE, PIN, BASE), (PLAY, BASE)], ids=["springs", "backlash"])
def test_energy_is_kept_without_damping(effects: tuple[HiddenEffect, ...]) -> None:
    loose = [
        HiddenEffect(
            e.effect,
            e.axis,
            e.location,
            {**e.parameters, **({"damping": 0.0} if "damping" in e.parameters else {})},
        )
        for e in effects
    ]
    leg, states = run(
        machine(*loose, damping=False), speeds=[2.0, -3.0] + [0.0] * (3 if len(loose) > 2 else 1) + [0.1]
    )
    energy = energies(leg, states)
    assert np.abs(energy - energy[0]).max() < 2e-6
    assert np.ptp([q[0] for q, _ in states]) > 0.2  # it did move


@pytest.mark.parametrize(
    "effects",
    [
        (HIP, HiddenEffect("coulomb_friction", "hip", parameters={"torque": 0.1})),
        (DRIVE, HiddenEffect("coulomb_friction", "knee", "joint", {"torque": 0.05})),
        (PLAY, HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.1}), BASE),
        (
            PLAY,
            HiddenEffect(
                "stribeck_friction", "knee", parameters={"coulomb": 0.05, "static": 0.1, "speed": 0.2}
            ),
            HiddenEffect("coulomb_friction", "hip", "joint", {"torque": 0.05}),
        ),
        (PLAY, HiddenEffect("quadratic_drag", "hip", parameters={"drag": 0.02})),
    ],
    ids=lambda effects: "+".join(e.effect for e in effects),
)
def test_resistance_only_takes_energy(effects: tuple[HiddenEffect, ...]) -> None:
    leg, states = run(machine(*effects), rows=400)
    energy = energies(leg, states)
    assert np.diff(energy).max() < 1e-9
    assert energy[0] - energy[-1] > 0.01


def test_within_the_gap_the_motor_turns_alone() -> None:
    """J a + B w = u up to the flank, while the link falls as if there were no motor."""
    leg = Integrator(machine(PLAY))
    state, rate, met = leg.start(*START), ACTUATOR_DAMPING / 0.0162, 0
    for t in np.arange(1, 25) * ROW:
        state = leg.advance(state, 0.0, 0.5, ROW)
        alone = 0.5 / ACTUATOR_DAMPING * (t - (1 - np.exp(-rate * t)) / rate)
        angle = leg.motors(state)[1]
        if angle - state[0][1] < 0.01:
            assert angle - START[1] == pytest.approx(alone, abs=1e-12)
        else:
            met += 1
            assert angle - START[1] < alone
    assert 3 < met < 20


def test_a_motor_that_sticks_leaves_the_link_on_its_spring() -> None:
    """As a leg whose motor 1 is part of the stand."""
    stuck = HiddenEffect("coulomb_friction", "hip", parameters={"torque": 50.0})
    leg, states = run(machine(HIP, stuck), rows=200)

    def hold(q: np.ndarray, v: np.ndarray, t: float) -> np.ndarray:
        f = np.zeros(6)
        f[THIGH] = 200.0 * (START[0] - q[THIGH]) - 0.3 * v[THIGH]
        f[MOTOR2] = -ACTUATOR_DAMPING * v[MOTOR2]
        return f

    reference = Leg(("thigh", "shank"), hold, rotors=(0.0, 0.0162))
    expected = reference.integrate(np.array([*START, 0.0, 0.0]), 200)
    assert {q[leg.leg.motors[0]] for q, _ in states} == {START[0]}
    np.testing.assert_allclose([q[0] for q, _ in states], expected[:, THIGH], atol=1e-8)


@pytest.mark.parametrize(
    ("soft", "stiff"),
    [
        (DRIVE, HiddenEffect("joint_compliance", "knee", parameters={"stiffness": 1e6, "damping": 3.0})),
        (PIN, HiddenEffect("joint_compliance", "knee", "joint", {"stiffness": 1e5, "damping": 0.3})),
        (BASE, HiddenEffect("base_compliance", parameters={"stiffness": 1e8, "damping": 1e3, "mass": 1.0})),
        (PLAY, HiddenEffect("backlash", "knee", parameters={"gap": 0.0, "stiffness": 1e6})),
    ],
    ids=lambda effect: effect.effect,
)
def test_a_stiff_spring_is_none(soft: HiddenEffect, stiff: HiddenEffect) -> None:
    _, rigid = run(Machine(), (0.5, -0.3), rows=100)
    far, near = (
        np.abs(
            np.array([q[:2] for q, _ in run(machine(e), (0.5, -0.3), rows=100)[1]]) - [q for q, _ in rigid]
        ).max()
        for e in (soft, stiff)
    )
    assert near < 2e-5 < 2e-4 < far


def test_what_the_rig_has_no_room_for_is_refused() -> None:
    with pytest.raises(SimulationError, match="room for one spring or gap"):
        VirtualLeg([DRIVE, PLAY])
    with pytest.raises(SimulationError, match="room for one compliant stand"):
        VirtualLeg([BASE, BASE])
    with pytest.raises(SimulationError, match="too fast to simulate"):
        VirtualLeg([HiddenEffect("backlash", "hip", parameters={"gap": 0.01, "stiffness": 1e12})])
    places = [("hip", "actuator"), ("knee", "actuator"), ("knee", "joint")]
    frictions = [HiddenEffect("coulomb_friction", a, p, {"torque": 0.1}) for a, p in places]
    with pytest.raises(SimulationError, match="two pins at most"):
        VirtualLeg([DRIVE, *frictions])
