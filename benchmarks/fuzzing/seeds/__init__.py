"""Small valid files of every kind that is read."""

from .logs import JOINT_STATE, bag, can_log, lerobot, mcap
from .machines import can_config, model, urdf
from .runs import design, played, run
from .tables import csv, description, recording, table, write_table

__all__ = [
    "JOINT_STATE", "bag", "can_config", "can_log", "csv", "description", "design", "lerobot", "mcap", "model",
    "played", "recording", "run", "table", "urdf", "write_table",
]  # fmt: skip
