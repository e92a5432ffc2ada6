"""Effects of a foot on the ground, visible only in recordings with measured forces."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model

from .base import Effect, SignalStage
from .motion import Motion
from .parameter import Place, Values
from .response import Response

#: What a model must have for one to apply.
NEEDS = "a [ground] table, and to be present at most once"


class OnGround(Effect):
    """An effect of a contact, which replaces what the model's ground states."""

    stage = SignalStage.MECHANISM

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Return whether the model has a ground and no such effect yet."""
        return model.ground is not None and not model.has(self.name)

    @abstractmethod
    def initial_values(self, motions: Sequence[Motion]) -> Sequence[Values]:
        """Return shapes to try, from what feet did along motions; none if they show nothing."""

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """Return no torque: a motion alone does not determine it, a simulation does."""
        return Response(np.zeros((0, *motion.position.shape)), offset=np.zeros_like(motion.position))
