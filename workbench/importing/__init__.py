"""A user's own leg, from an SDF or URDF with a loop, made a model: serial tree, transmission, linkage."""

from .assemblies import Assemblies, assemblies
from .contents import Contents, contents_of
from .import_model import Drives, import_model

__all__ = ["Assemblies", "Contents", "Drives", "assemblies", "contents_of", "import_model"]
