"""Effects whose numbers are in the structure of a model."""

from __future__ import annotations

import numpy as np

from workbench.models import Model

from .base import Effect, SignalStage
from .motion import Motion
from .parameter import Place, Values
from .response import Response


class Structural(Effect):
    """An effect whose own numbers are in the model's structure: inertia of its drives, or its linkage."""

    stage = SignalStage.MECHANISM

    def columns(self, motion: Motion) -> np.ndarray:
        """Return the torque of one unit of each parameter along a motion, (k, N, n)."""
        return np.zeros((0, *motion.position.shape))

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column per parameter; no free coefficient where identification gave them."""
        columns = self.columns(motion)
        if self.free(model):
            return Response(columns)
        stated = [getattr(model.linkage, p.name) for p in self.parameters]
        return Response(columns[:0], offset=np.tensordot(stated, columns, axes=1))

    def free(self, model: Model) -> int:
        """Return parameters that the data have to determine: none that an identification already gave."""
        stated = model.linkage is not None and model.linkage.identified
        return 0 if stated and not model.has(self.name) else len(self.parameters)
