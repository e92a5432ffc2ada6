"""S3N-Full: the inertia of the linkage that the serial tree leaves out, with its own Coriolis terms."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model, Placement

from .base import INF, Door, Effect, Parameter
from .chain import Build
from .motion import Motion
from .response import Response
from .structure import crank_of, inertia_columns, is_parallelogram
from .weights import add_inertia


class LinkageInertia(Effect):
    """Kinetic energy M11 w1^2/2 + M12 cos(alpha) w1 w2 + M22 w2^2/2 over the serial tree's."""

    name = "linkage_inertia"
    parameters = (
        Parameter("M11", "kg*m^2", lower=-INF),
        Parameter("M12", "kg*m^2", lower=-INF, about="factor of cos(alpha)"),
        Parameter("M22", "kg*m^2", lower=-INF),
    )
    door = Door.MECHANISM
    on_links = True
    adds_up = True
    basic = True
    tier = 1
    contains = ("reflected_inertia",)
    axes = "all"
    needs = "a parallelogram: two drives that turn two joints by ((1, 0), (1, 1))"
    source = "paper, Eqs. 16 to 20"
    shows = "inertia of both drives and a coupling that varies with the cosine of the knee angle"
    reveal = "sum- and difference-mode multisines at several knee angles"
    mujoco = "native: weightless bodies on the links"

    def applies(self, model: Model, key: EffectKey) -> bool:
        """On a parallelogram."""
        return is_parallelogram(model)

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """Three columns; no free coefficient where identification gave them."""
        columns = inertia_columns(motion)
        link = model.linkage
        if link is not None and self.free(model) == 0:
            fixed = np.tensordot([link.M11, link.M12, link.M22], columns, axes=1)
            return Response(columns[:0], offset=fixed)
        return Response(columns)

    def to_parameters(self, coefficients: np.ndarray, shape: Mapping[str, float]) -> dict[str, float]:
        """The increments themselves; none where they are not free."""
        return dict(zip(("M11", "M12", "M22"), map(float, coefficients), strict=False))

    def free(self, model: Model) -> int:
        """None where identification gave the increments and the model has not used them yet."""
        stated = model.linkage is not None and model.linkage.identified
        return 0 if stated and not model.has(self.name) else 3

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Bodies that have inertia and no weight."""
        add_inertia(build.spec, model, values["M11"], values["M12"], values["M22"], crank_of(model))
