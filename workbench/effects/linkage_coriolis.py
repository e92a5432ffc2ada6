"""The velocity terms that belong to the linkage's inertia."""

from __future__ import annotations

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model

from .base import WHOLE, Words
from .chain import Build
from .motion import Motion
from .parameter import Place, Values
from .response import Response
from .structural import Structural
from .structure import is_parallelogram


class LinkageCoriolis(Structural):
    """torque = (M12 sin(alpha) w2^2, -M12 sin(alpha) w1^2), the velocity terms of `linkage_inertia`:
    missing only in the variant `s3n_full_paper`.

    A body with inertia has its velocity terms already, so every variant in plain MJCF has them; only the
    paper's equation per step (variant ``s3n_full_paper``) leaves them out.
    """

    name = "linkage_coriolis"
    locations = WHOLE
    words = Words(
        source="paper, the term neglected before Eq. 21",
        shows="torque residual even in speed, growing with its square, zero where alpha = 0",
        reveal="fast opposed swings with the knee bent",
        mujoco="native: comes with linkage_inertia",
        needs="a parallelogram of variant s3n_full_paper",
    )

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Only to a variant that has the linkage's inertia without its velocity terms."""
        return is_parallelogram(model) and model.variant == "s3n_full_paper"

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """No free coefficient."""
        assert model.linkage is not None
        alpha = motion.position[:, 1] - motion.position[:, 0]
        scale = model.linkage.M12 * np.sin(alpha)
        w = motion.velocity
        torque = np.stack([scale * w[:, 1] ** 2, -scale * w[:, 0] ** 2], -1)
        return Response(np.zeros((0, *torque.shape)), offset=torque)

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Nothing to do: the bodies of linkage_inertia bring the velocity terms."""
