"""Gravity of the links that the serial tree leaves out."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model, Placement

from .base import INF, Door, Effect, Parameter, Trace
from .chain import Build
from .motion import Motion
from .response import Response
from .structure import crank_of, gravity_columns, is_parallelogram
from .weights import add_gravity


class LinkageGravity(Effect):
    """torque_i = -g_i sin(q_i), increments over the serial tree's gravity."""

    name = "linkage_gravity"
    parameters = (Parameter("g1", "N*m", lower=-INF), Parameter("g2", "N*m", lower=-INF))
    door = Door.MECHANISM
    depends_on = ("position",)
    on_links = True
    adds_up = True
    basic = True
    axes = "all"
    trace = Trace.EVEN
    needs = "a parallelogram: two drives that turn two joints by ((1, 0), (1, 1))"
    source = "potential energy of the parallelogram; the paper leaves it out (after Eq. 21)"
    shows = "torque residual a sine of each drive's angle, at every speed"
    reveal = "a slow sweep over the widest range of both drives"
    mujoco = "native: bodies on the links that have weight and next to no mass (fixed base)"

    def applies(self, model: Model, key: EffectKey) -> bool:
        """On a parallelogram."""
        return is_parallelogram(model)

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """Two columns; no free coefficient where identification gave them."""
        columns = gravity_columns(motion)
        link = model.linkage
        if link is not None and self.free(model) == 0:
            return Response(columns[:0], offset=np.tensordot([link.g1, link.g2], columns, axes=1))
        return Response(columns)

    def to_parameters(self, coefficients: np.ndarray, shape: Mapping[str, float]) -> dict[str, float]:
        """The increments themselves; none where they are not free."""
        return dict(zip(("g1", "g2"), map(float, coefficients), strict=False))

    def free(self, model: Model) -> int:
        """None where identification gave the increments and the model has not used them yet."""
        stated = model.linkage is not None and model.linkage.identified
        return 0 if stated and not model.has(self.name) else 2

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Bodies that have weight and next to no mass."""
        add_gravity(build.spec, model, values["g1"], values["g2"], crank_of(model))
