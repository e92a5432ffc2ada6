"""The serial tree in Pinocchio: a second engine beside MuJoCo, and the regressor for identification."""

from .build import Beside, beside_the_links
from .tree import SerialTree

__all__ = ["Beside", "SerialTree", "beside_the_links"]
