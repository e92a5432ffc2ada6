"""Policies in the normalised simulator: tasks, worlds, learning, bundles, virtual hardware.

Nothing here needs torch until something learns: `ppo`, `learn`, `checkpoint`, `curve`, `export` and
`warp_worlds` belong to the extra ``training``.
"""

from .environment import Environment
from .machine import Machine, make_machine
from .randomisation import LEG_RANDOMISATION, Randomisation
from .tasks import TASKS, Task

__all__ = [
    "LEG_RANDOMISATION",
    "TASKS",
    "Environment",
    "Machine",
    "Randomisation",
    "Task",
    "make_machine",
]
