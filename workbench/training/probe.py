"""How many numbers each observation has: found by looking at one world."""

from __future__ import annotations

from .environment import Environment
from .machine import Machine
from .task import Task
from .worlds import BatchWorlds


def sizes(task: Task, machine: Machine, privileged: bool = False) -> list[int]:
    """Numbers in each of the task's observations."""
    now = Environment(task, machine, BatchWorlds(machine, 1, threads=1), 1).situation()
    table = task.privileged if privileged else task.observations
    return [int(entry.function(now).shape[-1]) for entry in table]
