"""The serial tree in Pinocchio: a second engine beside MuJoCo."""

from .build import beside_the_links
from .tree import SerialTree

__all__ = ["SerialTree", "beside_the_links"]
