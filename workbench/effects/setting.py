"""Settings of the model that a diagnosis changes, besides the parameters of effects."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from workbench.models import Model


@dataclass(frozen=True)
class Setting:
    """A property of a model that only some effects need.

    Attributes:
        name: in `Diagnosis.settled`.
        get, put: its value, and the model with another one, as to which `put` raises ValueError or TypeError.
        in_shape: what it is called beside the parameters that a fit does not solve for linearly; empty where
            it is settled after the fit.
        words: what a model states of it, in words; nothing to say: empty.
    """

    name: str
    get: Callable[[Model], float]
    put: Callable[[Model, float], Model]
    in_shape: str = ""
    words: Callable[[Model], str] = lambda model: ""


def _slide(model: Model, value: float) -> Model:
    if not 0.0 < float(value) < math.inf:
        raise ValueError(f"sliding_speed {value} is not positive")
    return replace(model, sliding_speed=float(value))


def _damp(model: Model, value: float) -> Model:
    if not 0.0 <= float(value) < math.inf:
        raise ValueError(f"flank_retardation_s {value} is negative")
    return replace(model, flank_retardation_s=float(value))


def _flanks(model: Model) -> str:
    late = model.flank_retardation_s
    return f"its flanks are damped by {1e3 * late:.3g} ms times their stiffness" if late else ""


def _brake(model: Model, value: float) -> Model:
    return replace(model, actuators=replace(model.actuators, full_braking=bool(value)))


def _braking(model: Model) -> str:
    return "torque against the motion keeps the stall torque" if model.actuators.full_braking else ""


#: How fast dry friction sets in [rad/s or m/s].
SLIDING_SPEED = Setting("sliding_speed", lambda model: model.sliding_speed, _slide)
#: How the flanks of a gap are damped: damping over stiffness [s].
FLANK_RETARDATION = Setting(
    "flank_retardation_s", lambda model: model.flank_retardation_s, _damp, "retardation", _flanks
)
#: Whether a line of torque over speed leaves braking alone.
FULL_BRAKING = Setting(
    "full_braking", lambda model: float(model.actuators.full_braking), _brake, "full_braking", _braking
)
SETTINGS = (SLIDING_SPEED, FLANK_RETARDATION, FULL_BRAKING)
