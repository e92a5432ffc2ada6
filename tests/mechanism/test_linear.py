"""The linear plant is the derivative of the simulation, in time and in frequency."""

from dataclasses import replace

import control
import numpy as np
import pytest

from workbench.mechanism import ClosedChain, linearise, simulate
from workbench.models import read_model

from .chains import NAMES, central, chain, joints_at

INERTIA, DAMPING, STEP = (0.0162, 0.01), (0.0972, 0.05), 1e-3


@pytest.mark.parametrize("name", NAMES)
def test_stiffness_is_the_slope_of_gravity(name: str) -> None:
    mechanism, rest = chain(name), np.zeros(2)
    q = mechanism.drive_position(joints_at(name, (0.3, 0.6)))
    plant = linearise(mechanism, q, INERTIA, DAMPING)
    slope = [central(lambda x: mechanism.reduced_dynamics(x, rest).gravity, q, e) for e in np.eye(2)]
    np.testing.assert_allclose(plant.stiffness, -np.transpose(slope), atol=1e-8)
    np.testing.assert_allclose(plant.holding, -mechanism.reduced_dynamics(q, rest).gravity)


def test_the_legs_plant_in_closed_form() -> None:
    """Inertia of the paper, M12 with cos alpha, and pendulums for gravity."""
    q = np.array([-0.2, 1.1])
    plant = linearise(chain("leg"), q, INERTIA, DAMPING)
    coupling = 0.005413 * np.cos(q[1] - q[0])
    mass = np.array([[0.03173, coupling], [coupling, 0.00748]]) + np.diag(INERTIA)
    np.testing.assert_allclose(plant.mass, mass, atol=2e-9)
    gravity = np.diag([1.850411, 0.274007] * np.cos(q))
    np.testing.assert_allclose(plant.stiffness, gravity, atol=5e-7)
    omega = np.array([0.5, 60.0])
    expected = [np.linalg.inv(1j * w * mass + np.diag(DAMPING) + gravity / (1j * w)) for w in omega]
    np.testing.assert_allclose(plant.frequency_response(omega), expected, rtol=1e-5)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("drive", [0, 1])
def test_frequency_response_of_the_nonlinear_simulation(name: str, drive: int) -> None:
    """A small sine torque, begun on the orbit that the linear plant predicts, stays on it for a period."""
    mechanism = chain(name)
    plant = linearise(mechanism, mechanism.drive_position(joints_at(name, (0.5, 0.4))), INERTIA, DAMPING)
    omega, small, samples = 2 * np.pi / 0.1, 1e-3, 100
    # the torque is held over a sample, so that the plant seen is the one behind a zero-order hold
    held = control.c2d(plant.state_space(), STEP)
    orbit = held(np.exp(1j * omega * STEP))[:, drive]
    turn = np.exp(1j * omega * STEP * np.arange(samples + 1))
    sine = np.outer(turn.real[:-1], np.eye(2)[drive])
    up, down = (
        simulate(
            mechanism, INERTIA, DAMPING, plant.holding + sign * sine, STEP,
            plant.posture + sign * orbit[:2].real, sign * orbit[2:].real,
        )
        for sign in (small, -small)
    )  # fmt: skip
    expected = np.outer(turn, orbit).real
    found = np.hstack([up.position - down.position, up.velocity - down.velocity]) / (2 * small)
    np.testing.assert_allclose(found[:, :2], expected[:, :2], atol=1e-5 * np.abs(orbit[:2]).max())
    np.testing.assert_allclose(found[:, 2:], expected[:, 2:], atol=1e-5 * np.abs(orbit[2:]).max())


def test_state_space_and_frequency_response_are_one_plant() -> None:
    plant = linearise(chain("ankle"), np.zeros(2), INERTIA, DAMPING)
    omega = np.array([2.0, 200.0])
    speeds = np.moveaxis(plant.state_space()(1j * omega)[2:], -1, 0)
    np.testing.assert_allclose(speeds, plant.frequency_response(omega), rtol=1e-12)


def test_near_a_dead_point_differences_stay_away_from_it() -> None:
    """Where a drive moves its joint six times as far as itself, a milliradian of it is a large step."""
    found = closed_chain_of("four_bar")
    q, rest, step = found.drive_position(np.array([-0.4, 0.25])), np.zeros(2), 1e-5
    plant = linearise(found, q, INERTIA, DAMPING)
    ends = [[found.reduced_dynamics(q + way * step * e, rest).gravity for way in (1, -1)] for e in np.eye(2)]
    slope = np.transpose([(ahead - behind) / (2.0 * step) for ahead, behind in ends])
    np.testing.assert_allclose(plant.stiffness, -slope, atol=2e-5 * np.abs(slope).max())


def closed_chain_of(name: str) -> ClosedChain:
    """A shipped mechanism without its limits."""
    mechanism = read_model(name).closed_chain
    assert mechanism is not None
    return ClosedChain(replace(mechanism, limits=()))
