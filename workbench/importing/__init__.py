"""A user's own leg, from an SDF or URDF with a loop, made a model: serial tree, transmission, linkage."""

from .contents import Contents, contents_of
from .import_model import Drives, import_model

__all__ = ["Contents", "Drives", "contents_of", "import_model"]
