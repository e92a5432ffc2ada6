"""A leg of a user's own, from a file with a loop (SDF, URDF, MJCF): tree, transmission, linkage."""

from .assemblies import assemblies
from .contents import contents_of
from .hardware import described, is_reference_leg, own_plants, own_rig
from .import_model import Drives, import_model
from .opened import is_mjcf

__all__ = [
    "Drives", "assemblies", "contents_of", "described", "import_model", "is_mjcf", "is_reference_leg",
    "own_plants", "own_rig",
]  # fmt: skip
