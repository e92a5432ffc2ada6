"""Training of policies in the normalised simulator: tasks, worlds, learning, bundles, virtual hardware.

Nothing here needs torch until something learns: `ppo`, `learn`, `checkpoint`, `curve`, `export` and
`warp_worlds` belong to the extra ``training``.
"""

from .machine import make_machine
from .randomisation import LEG_RANDOMISATION, Randomisation
from .task import Task
from .tasks import REACH, TASKS
from .terms import Observation, Reward

__all__ = [
    "LEG_RANDOMISATION",
    "REACH",
    "TASKS",
    "Observation",
    "Randomisation",
    "Reward",
    "Task",
    "make_machine",
]
