"""Presliding friction follows Dahl's equation in time, though the rig integrates it over position."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.rigs.lagrange import MOTOR1, MOTOR2, Leg
from workbench.rigs import HiddenEffect
from workbench.rigs.hidden import install
from workbench.rigs.hysteresis import Hysteresis
from workbench.rigs.integrate import Integrator
from workbench.rigs.machine import ACTUATOR_DAMPING, Machine

START = (-0.5, 0.6)


def leg(torque: float, stiffness: float, location: str = "actuator") -> Integrator:
    made = Machine()
    install(
        HiddenEffect("presliding_hysteresis", "knee", location, {"torque": torque, "stiffness": stiffness}),
        made,
    )
    return Integrator(made)


@pytest.mark.parametrize(("location", "slip"), [("actuator", (0.0, 1.0)), ("joint", (-1.0, 1.0))])
@pytest.mark.parametrize("amplitude", [0.1, 1.5])
def test_motion_is_that_of_the_equation_in_time(
    location: str, slip: tuple[float, float], amplitude: float
) -> None:
    """Small torques stay within presliding, large ones go round the whole loop."""
    level, stiffness, z, held = 0.3, 25.0, [0.0], np.zeros(2)

    def torque(q: np.ndarray, v: np.ndarray, t: float) -> np.ndarray:
        f = np.zeros(6)
        d1, d2 = slip
        f[MOTOR1] = held[0] - ACTUATOR_DAMPING * v[MOTOR1] - d1 * level * z[0]
        f[MOTOR2] = held[1] - ACTUATOR_DAMPING * v[MOTOR2] - d2 * level * z[0]
        return f

    reference = Leg(("thigh", "shank"), torque)

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        z[0] = y[4]
        w = slip[0] * y[2] + slip[1] * y[3]
        acceleration = reference.acceleration(reference.spread @ y[:2], reference.spread @ y[2:4], t)
        return np.array([*y[2:4], *acceleration, stiffness / level * w * (1 - np.sign(w) * y[4])])

    made = leg(level, stiffness, location)
    state, ours, theirs = made.start(*START), [], [np.array([*START, 0.0, 0.0, 0.0])]
    for row in range(160):
        amplitude *= -1.0 if row % 40 == 39 else 1.0
        q1, q2 = state[0]
        held[:] = 1.85 * np.sin(q1), 0.27 * np.sin(q2) + amplitude  # gravity's, and a square wave
        state = made.advance(state, *held, 1e-3)
        ours.append([*state[0], *state[1]])
        theirs.append(solve_ivp(slope, (0, 1e-3), theirs[-1], rtol=1e-8, atol=1e-11).y[:, -1])
    np.testing.assert_allclose(np.array(ours), np.array(theirs)[1:, :4], atol=1e-6)


def test_large_slip_is_coulomb_friction_and_small_slip_a_spring() -> None:
    friction = Hysteresis(0.3, 25.0)
    assert friction.torque(1e-6, 1.0) == pytest.approx(-25.0 * 1e-6, rel=1e-3)
    for position, expected in ((1.0, -0.3), (0.0, 0.3)):
        assert friction.torque(position, 0.0) == pytest.approx(expected, abs=1e-9)
        friction.settle(position)
    friction.start(0.0)
    assert friction.torque(0.0, 0.0) == 0.0


def test_it_gives_back_no_more_than_it_stored() -> None:
    """Work on it is its stored energy (f z)^2 / 2 k plus f z^2 |w|, which is never negative."""
    friction, generator = Hysteresis(0.3, 25.0), np.random.default_rng(5)
    position, work, stored = 0.0, 0.0, 0.0
    for target in generator.uniform(-0.05, 0.05, 200):
        path = np.linspace(position, target, 400)
        z = np.array([friction.state(x) for x in path])
        work += 0.3 * np.trapezoid(z, path)
        friction.settle(target)
        position = target
        assert work > stored - 1e-9 and work >= (0.3 * z[-1]) ** 2 / 50.0 - 1e-7
        stored = max(stored, 0.0)
    assert work > 0.5


def test_no_friction_is_the_rigid_leg() -> None:
    made, rigid = leg(0.0, 25.0), Integrator(Machine())
    state, alone = made.start(*START), rigid.start(*START)
    for _ in range(200):
        state, alone = made.advance(state, 0.3, -0.2, 1e-3), rigid.advance(alone, 0.3, -0.2, 1e-3)
    np.testing.assert_allclose(state, alone, atol=1e-12)
