"""The worlds of a task for learners of one's own; where Gymnasium is missing, that is said."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np
import pytest

from workbench.core import InputError
from workbench.training.gym import vector_environment

from .make import environment


def test_vector_environment() -> None:
    if find_spec("gymnasium") is None:
        with pytest.raises(InputError, match=r"pip install 'robot-workbench\[gym\]'"):
            vector_environment()
        return
    import gymnasium

    env = gymnasium.make_vec("workbench.training.gym:workbench/reach-v0", num_envs=4)
    first, info = env.reset(seed=3)
    assert env.observation_space.contains(first) and info["privileged"].shape == (4, 0)
    ended = 0
    for _ in range(225):
        seen, reward, terminated, truncated, info = env.step(np.zeros((4, 2), np.float32))
        assert env.observation_space.contains(seen) and reward.shape == (4,)
        ended += int((terminated | truncated).sum())
        if truncated.any():
            assert all(x.shape == first[0].shape for x in info["final_obs"][info["_final_obs"]])
    assert ended == 4
    np.testing.assert_array_equal(env.reset(seed=3)[0], first)


def test_the_last_observation_is_kept_where_it_is_asked_for() -> None:
    env = environment("reach")
    env.keep_final = True
    env.steps[:] = env.task.episode_steps - 1.0
    made = env.step(np.zeros((4, 2)))
    assert made.timed_out.all() and env.final.shape == made.observation.shape
    assert np.abs(env.final - made.observation).max() > 1e-3  # that is of the new episode
