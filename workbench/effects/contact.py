"""Effects of a foot on the ground, which only recordings with measured forces show."""

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
    """An effect of a contact, in place of what the model's ground has."""

    stage = SignalStage.MECHANISM

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Where the model has a ground, once."""
        return model.ground is not None and not model.has(self.name)

    @abstractmethod
    def initial_values(self, motions: Sequence[Motion]) -> Sequence[Values]:
        """Shapes to try by what feet did along motions; none where they show nothing."""

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """No torque that a motion alone would tell; simulations do."""
        return Response(np.zeros((0, *motion.position.shape)), offset=np.zeros_like(motion.position))
