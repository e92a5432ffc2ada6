"""The serial tree in Pinocchio: a second engine beside MuJoCo, and the regressor for identification."""

from .base_parameters import BaseParameters, base_parameters
from .build import Beside, beside_the_links
from .tree import SerialTree

__all__ = ["BaseParameters", "Beside", "SerialTree", "base_parameters", "beside_the_links"]
