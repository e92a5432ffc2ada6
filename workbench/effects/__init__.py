"""The catalogue of physical effects, one small file each, and how a model is built from them."""

from .base import Door, Effect, Parameter, Response
from .build import Plant, build, compile_plant, tendon_row
from .catalogue import EFFECTS, contains, effect_named, places
from .chain import Build, FrictionTerm, SensorErrors, TorqueChain, TorqueTerm
from .check import axis_units, check_effect, load_model
from .motion import Motion, held

__all__ = [
    "EFFECTS",
    "Build",
    "Door",
    "Effect",
    "FrictionTerm",
    "Motion",
    "Parameter",
    "Plant",
    "Response",
    "SensorErrors",
    "TorqueChain",
    "TorqueTerm",
    "axis_units",
    "build",
    "check_effect",
    "compile_plant",
    "contains",
    "effect_named",
    "held",
    "load_model",
    "places",
    "tendon_row",
]
