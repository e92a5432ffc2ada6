"""A user's own leg, from a file with a loop (SDF, URDF or MJCF), made a model: tree, drives, linkage."""

from .assemblies import Assemblies, assemblies
from .contents import Contents, contents_of
from .from_mjcf import is_mjcf
from .import_model import Drives, import_model

__all__ = ["Assemblies", "Contents", "Drives", "assemblies", "contents_of", "import_model", "is_mjcf"]
