"""The number of values in each observation, found from one world."""

from __future__ import annotations

from .environment import Environment
from .machine import Machine
from .task import Task
from .worlds import BatchWorlds


def sizes(task: Task, machine: Machine, privileged: bool = False) -> list[int]:
    """Return the number of values in each observation of the task."""
    now = Environment(task, machine, BatchWorlds(machine, 1, threads=1), 1).situation()
    table = task.privileged if privileged else task.observations
    return [int(entry.function(now).shape[-1]) for entry in table]
