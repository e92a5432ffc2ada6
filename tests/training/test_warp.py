"""The GPU's engine gives what the CPU's gives; here on the CPU, where its kernels compile in a minute."""

import numpy as np
import torch
import warp as wp

from workbench.training.environment import Environment
from workbench.training.randomisation import Randomisation, world_fields
from workbench.training.tasks import TASKS
from workbench.training.worlds import BatchWorlds

from .make import actions, machine

WORLDS = 3


def test_both_engines_step_alike_with_every_world_randomised() -> None:
    wp.config.optimization_level = 0  # compiling takes longer than running
    from workbench.training.warp_worlds import WarpWorlds

    made, task = machine("quadruped"), TASKS["circular"]
    fields = world_fields(made, Randomisation(legs="heavy_leg_rand"), WORLDS, seed=2)
    quiet = Randomisation(push=0.0)
    one = Environment(task, made, BatchWorlds(made, WORLDS, fields, threads=1), WORLDS, quiet, noise=False)
    other = Environment(task, made, WarpWorlds(made, WORLDS, fields, "cpu"), WORLDS, quiet, noise=False)
    everywhere = np.ones(WORLDS, bool)
    qpos, qvel = one.worlds.qpos.copy(), one.worlds.qvel.copy()
    qpos[:, 2] = made.height - 0.002  # on the ground from the first step
    one.worlds.put(everywhere, qpos, qvel)
    other.worlds.put(torch.as_tensor(everywhere), *(torch.as_tensor(x).float() for x in (qpos, qvel)))
    other.command = torch.as_tensor(one.command).float()
    for action in actions("circular", WORLDS, 4):
        a, b = one.step(action), other.step(torch.as_tensor(action).float())
    assert not a.ended.any() and not b.ended.any()
    assert float(np.abs(one.situation().foot_force).max()) > 10.0
    np.testing.assert_allclose(other.worlds.qpos.numpy(), one.worlds.qpos, atol=2e-5)
    np.testing.assert_allclose(other.worlds.qvel.numpy(), one.worlds.qvel, atol=2e-3)
    np.testing.assert_allclose(b.observation.numpy(), a.observation, atol=2e-3)
    np.testing.assert_allclose(b.reward.numpy(), a.reward, atol=1e-4)
    # the worlds differ from each other, and each from the nominal machine
    assert np.ptp(one.worlds.qvel, axis=0).max() > 1e-2
