"""The worlds of a task as a Gymnasium vector environment, for your own learning algorithm.

    env = gymnasium.make_vec("workbench.training.gym:workbench/reach-v0", num_envs=256)   # a shipped task
    env = vector_environment("my_task.py", "my_leg.toml", num_envs=256)                   # one's own

It is the simulation that `train` learns in: the same observations, noise, rewards and draws. Gymnasium is
not a dependency; where it is installed, this module registers the tasks as it is imported, which
``workbench.training.gym:`` before a name makes Gymnasium do.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core import InputError

from .environment import ACTION_LIMIT, Environment
from .injected import with_torques
from .machine import Machine, make_machine
from .probe import sizes
from .randomisation import Randomisation, world_fields
from .task import Task
from .task_file import load_task, posed
from .tasks import TASKS
from .tried import try_task
from .worlds import BatchWorlds

if TYPE_CHECKING:
    from gymnasium.vector import VectorEnv  # pyright: ignore[reportMissingImports]
else:
    try:
        from gymnasium.vector import VectorEnv
    except ImportError:
        VectorEnv = object


class WorkbenchVectorEnv(VectorEnv):
    """Worlds of a task; an episode that ends restarts in the same step, with its last observation in
    ``info``.

    Args:
        task: what is to be done.
        machine: with what.
        num_envs: worlds W.
        seed: of all that is drawn.
        randomisation: what differs from world to world; the task's own if left out.
    """

    def __init__(
        self, task: Task, machine: Machine, num_envs: int = 1, seed: int = 0,
        randomisation: Randomisation | None = None,
    ) -> None:  # fmt: skip
        try:
            from gymnasium.spaces import Box  # pyright: ignore[reportMissingImports]
            from gymnasium.vector import AutoresetMode  # pyright: ignore[reportMissingImports]
            from gymnasium.vector.utils import batch_space  # pyright: ignore[reportMissingImports]
        except ImportError as error:
            remedy = "install the extra: pip install 'robot-workbench[gym]'"
            raise InputError("gymnasium is not installed", remedy=remedy) from error
        self.task, self.machine, self.num_envs, self._seed = task, machine, num_envs, seed
        self._drawn = randomisation or task.differences()
        count = int(sum(sizes(task, machine)))
        high = np.full(machine.size, ACTION_LIMIT, np.float32)
        self.single_observation_space = Box(-np.inf, np.inf, (count,), np.float32)
        self.single_action_space = Box(-high, high, dtype=np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.metadata = {"autoreset_mode": AutoresetMode.SAME_STEP, "render_modes": []}
        self.spec, self.render_mode, self.closed = None, None, False
        self._worlds = self._begun(seed)

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Restart all worlds; return the first observation (W, k), and the additional ones of the critic."""
        del options
        self._seed = self._seed + 1 if seed is None else seed
        self._worlds = self._begun(self._seed)
        seen, privileged = self._worlds.observe()
        return np.asarray(seen, np.float32), {"privileged": privileged}

    def step(
        self, actions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Run one policy step of 18 ms; return observation (W, k), reward, terminated, truncated (W,),
        info.
        """
        made = self._worlds.step(np.asarray(actions, float))
        info: dict[str, Any] = {"privileged": made.privileged, "terms": made.terms}
        ended = np.asarray(made.ended)
        if ended.any() and self._worlds.final is not None:
            final = np.empty(self.num_envs, object)
            for k in np.flatnonzero(ended):
                final[k] = np.asarray(self._worlds.final[k], np.float32)
            info |= {"final_obs": final, "_final_obs": ended.copy()}
        late = np.asarray(made.timed_out)
        return np.asarray(made.observation, np.float32), np.asarray(made.reward), ended & ~late, late, info

    def close(self, **kwargs: Any) -> None:
        """Do nothing: no resource is held."""
        self.closed = True

    def _begun(self, seed: int) -> Environment:
        fields = world_fields(self.machine, self._drawn, self.num_envs, seed)
        worlds = with_torques(BatchWorlds(self.machine, self.num_envs, fields), self.machine)
        return Environment(self.task, self.machine, worlds, self.num_envs, self._drawn, seed, keep_final=True)


def vector_environment(
    task: str = "reach", model: str = "leg", num_envs: int = 1, variant: str | None = None, seed: int = 0,
    **options: Any,
) -> WorkbenchVectorEnv:  # fmt: skip
    """Return the worlds of a shipped task, or of a task file, with the machine of a model.

    Args:
        task: a name, or a file (.toml, .py).
        model: a name, or a file.
        num_envs: worlds.
        variant: of the model; its own if left out.
        seed: of all that is drawn.
        options: what Gymnasium adds, as ``vectorization_mode``; not looked at.

    Raises:
        InputError: no such task or model, or gymnasium is not installed.
    """
    from workbench.effects import load_model

    del options
    if not task.endswith((".toml", ".py")) and task not in TASKS:
        raise InputError(
            f"no task is called '{task}'", remedy=f"choose one of {', '.join(TASKS)}, or give a file"
        )
    wanted = TASKS[task] if task in TASKS else load_task(Path(task))
    machine = posed(wanted, make_machine(wanted.machine, load_model(model), variant))
    if wanted.suffix == ".py":
        try_task(wanted, machine, Path(task))
    return WorkbenchVectorEnv(wanted, machine, num_envs, seed)


def register() -> None:
    """Register the shipped tasks in Gymnasium as ``workbench/TASK-v0``; do nothing where it is missing."""
    try:
        import gymnasium  # pyright: ignore[reportMissingImports]
    except ImportError:
        return
    for name in TASKS:
        gymnasium.register(
            f"workbench/{name}-v0", vector_entry_point="workbench.training.gym:vector_environment",
            kwargs={"task": name},
        )  # fmt: skip


register()
