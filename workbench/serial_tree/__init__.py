"""The serial tree in Pinocchio: a second engine beside MuJoCo, and the regressor for identification."""

from .base_parameters import BaseParameters, base_parameters
from .tree import SerialTree

__all__ = ["BaseParameters", "SerialTree", "base_parameters"]
