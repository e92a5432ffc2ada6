"""Settings of a model that a diagnosis changed belong to the effects that need them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from workbench.core import EffectKey
from workbench.models import Model

from .catalogue import effect_named
from .setting import SETTINGS


def with_settled(model: Model, settled: Mapping[str, float], effects: Iterable[EffectKey]) -> Model:
    """Return the model with the settings that these effects need, as they were found.

    Args:
        model: before the effects are added.
        settled: `Diagnosis.settled`, by the names of `SETTINGS`.
        effects: what is to be added.

    Raises:
        ValueError, TypeError: a value that no diagnosis gives.
    """
    needed = {s for key in effects for s in effect_named(key.effect).parameters.settles}
    for setting in SETTINGS:
        if setting in needed and settled.get(setting.name) is not None:
            model = setting.put(model, settled[setting.name])
    return model
