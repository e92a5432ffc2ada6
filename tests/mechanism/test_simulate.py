"""Motion of the closed chain: energy is kept, work is accounted for, dead points are met with a time."""

import numpy as np
import pytest

from workbench.core import SimulationError
from workbench.mechanism import Motion, simulate

from .chains import NAMES, chain, joints_at

STEP = 1e-3


def total_energy(name: str, motion: Motion, inertia: float) -> np.ndarray:
    """Of links and rotors at every sample [J]."""
    links = [chain(name).energy(q, v) for q, v in zip(motion.position, motion.velocity, strict=True)]
    return np.array(links) + 0.5 * inertia * np.sum(motion.velocity**2, axis=1)


@pytest.mark.parametrize("name", NAMES)
def test_energy_is_kept(name: str) -> None:
    """The leg falls; without damping and torque nothing is lost."""
    q0 = chain(name).drive_position(joints_at(name, (0.4, 0.5)))
    motion = simulate(chain(name), [0.002] * 2, [0.0] * 2, np.zeros((80, 2)), STEP, q0, np.array([0.8, -0.6]))
    energy = total_energy(name, motion, 0.002)
    assert np.ptp(motion.position, axis=0).min() > 0.01
    np.testing.assert_allclose(energy, energy[0], atol=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_energy_grows_by_the_work_of_the_drives(name: str) -> None:
    """dE/dt = tau . v - B v . v, with a torque that changes from sample to sample."""
    time = STEP * np.arange(100)
    torque = 0.4 * np.column_stack([np.sin(40 * time), np.cos(25 * time)])
    damping = 0.05
    q0 = chain(name).drive_position(joints_at(name, (0.4, 0.5)))
    motion = simulate(chain(name), [0.005] * 2, [damping] * 2, torque, STEP, q0)
    v = motion.velocity
    work = np.sum(torque * np.diff(motion.position, axis=0), axis=1)  # exact, the torque is held
    # Simpson, with the speed in between from the motion's cubic
    middle = 1.5 * np.diff(motion.position, axis=0) / STEP - 0.25 * (v[1:] + v[:-1])
    lost = damping * STEP / 6 * np.sum(v[1:] ** 2 + 4 * middle**2 + v[:-1] ** 2, axis=1)
    gained = np.diff(total_energy(name, motion, 0.005))
    assert np.abs(work).sum() > 0.005
    np.testing.assert_allclose(np.cumsum(gained), np.cumsum(work - lost), atol=1e-8)


def test_it_is_of_fourth_order() -> None:
    leg, torque = chain("five_bar"), np.tile([0.5, -0.3], (10, 1))
    q0 = leg.drive_position(joints_at("five_bar", (0.5, 0.5)))
    ends = [
        simulate(leg, [0.006] * 2, [0.04] * 2, torque, 0.01, q0, substeps=k).position[-1] for k in (1, 2, 8)
    ]
    coarse, fine = (np.abs(end - ends[-1]).max() for end in ends[:2])
    assert fine < coarse / 12


def test_a_motion_out_of_the_workspace_says_when() -> None:
    five_bar = chain("five_bar")
    q0 = five_bar.drive_position(joints_at("five_bar", (0.5, 0.5)))
    with pytest.raises(SimulationError, match=r"five_bar.sdf: t = 0\.\d+ s: the loops .* drive_1 = "):
        simulate(five_bar, [0.006] * 2, [0.04] * 2, np.tile([8.0, -8.0], (300, 1)), STEP, q0)
