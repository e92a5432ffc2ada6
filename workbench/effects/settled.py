"""What a diagnosis settles of the model itself, beside the parameters of the effects it finds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

from workbench.core import EffectKey
from workbench.models import Model

from .catalogue import effect_named


def with_settled(model: Model, settled: Mapping[str, float], effects: Iterable[EffectKey]) -> Model:
    """The model with those of its own properties that these effects need as they were found.

    Args:
        model: before the effects are added.
        settled: `Diagnosis.settled`: ``sliding_speed`` [rad/s or m/s], how friction sets in,
            ``flank_retardation_s`` [s], how the flanks of a gap meet, and ``full_braking``, whether a
            speed-torque line leaves braking alone.
        effects: what is to be added.

    Raises:
        ValueError, TypeError: a value that no diagnosis gives.
    """
    names = [key.effect for key in effects]
    speed, braking = settled.get("sliding_speed"), settled.get("full_braking")
    if speed is not None and any(effect_named(name).dry for name in names):
        if not 0.0 < float(speed) < math.inf:
            raise ValueError(f"sliding_speed {speed} is not positive")
        model = replace(model, sliding_speed=float(speed))
    retardation = settled.get("flank_retardation_s")
    if retardation is not None and "backlash" in names:
        if not 0.0 <= float(retardation) < math.inf:
            raise ValueError(f"flank_retardation_s {retardation} is negative")
        model = replace(model, flank_retardation_s=float(retardation))
    if braking is not None and "speed_torque_limit" in names:
        model = replace(model, actuators=replace(model.actuators, full_braking=bool(braking)))
    return model
