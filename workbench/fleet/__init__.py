"""Many logs of many robots: one diagnosis per robot, side by side, and what robots have in common."""

from .page import fleet_sheet
from .result import fleet_dict, summarise
from .robots import Robot, find_robots
from .run import run_fleet
from .spread import spread
from .store import files_read
from .table import fleet_table

__all__ = [
    "Robot", "files_read", "find_robots", "fleet_dict", "fleet_sheet", "fleet_table", "run_fleet", "spread",
    "summarise",
]  # fmt: skip
