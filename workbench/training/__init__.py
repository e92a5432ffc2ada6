"""Policies in the normalised simulator: tasks, worlds, learning, bundles, virtual hardware.

Nothing here needs torch until something learns: `ppo`, `learn`, `checkpoint`, `curve`, `export` and
`warp_worlds` belong to the extra ``training``.
"""

from .environment import Environment
from .machine import Machine, make_machine
from .randomisation import LEG_RANDOMISATION, Randomisation
from .situation import Situation
from .task import Task
from .tasks import CIRCULAR, PITCH, REACH, TASKS
from .terms import Observation, Reward

__all__ = [
    "CIRCULAR",
    "LEG_RANDOMISATION",
    "PITCH",
    "REACH",
    "TASKS",
    "Environment",
    "Machine",
    "Observation",
    "Randomisation",
    "Reward",
    "Situation",
    "Task",
    "make_machine",
]
