"""A link whose centre of mass, or mass, is not where the model has it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.core import EffectKey
from workbench.models import BodyNumbers, Model, Placement

from .base import INF, Door, Effect, Parameter, Trace
from .chain import Build
from .links import Link, link_at, link_of, reshape, shifting, with_moment
from .motion import Motion
from .response import Response
from .structure import is_parallelogram


class FirstMomentError(Effect):
    """Mass times lever of an axis' link is more by `along` (towards the next joint) and `across` that.

    The link keeps its mass and the inertia about its centre; the centre moves by the moment over the mass.
    """

    name = "first_moment_error"
    parameters = (
        Parameter("along", "kg*m", lower=-INF, about="added to what the model has"),
        Parameter("across", "kg*m", lower=-INF, about="a quarter turn about the axis from it"),
    )
    door = Door.MECHANISM
    on_links = True
    adds_up = True
    trace = Trace.EVEN
    needs = "a hinge whose link has a mass; of a parallelogram the linkage's increments say it"
    source = (
        "base parameters of a link; Khalil and Dombre, Modeling, Identification and Control of Robots, Ch. 9"
    )
    shows = "torque residual a sine of the link's angle to gravity, on its axis and those before it"
    reveal = "a slow sweep of this axis over its whole range, the others held; then a fast one"
    mujoco = "native: the body's centre of mass"

    def applies(self, model: Model, key: EffectKey) -> bool:
        """To a hinge whose body has a mass."""
        return link_of(model, key.axis) is not None and not is_parallelogram(model)

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """Two columns: minus what the shifted mass needs, per kg m."""
        assert place is not None
        link, centre = self._now(model, place)
        return Response(
            -np.stack([shifting(motion, place.index, w, centre) for w in (link.along, link.across)])
        )

    def bounds(self, model: Model, place: Placement | None) -> tuple[np.ndarray, np.ndarray]:
        """The centre stays within the reach of its link, whichever way."""
        assert place is not None
        link, centre = self._now(model, place)
        own = link.inertial.mass * np.array([link.along, link.across]) @ (centre - link.anchor)
        reach = link.inertial.mass * link.size
        return np.minimum(-reach - own, 0.0), np.maximum(reach - own, 0.0)

    def in_file(self, model: Model, place: Placement | None, values: Mapping[str, float]) -> BodyNumbers:
        """The body's centre of mass."""
        assert place is not None
        return BodyNumbers(model.joints[place.index])

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """The body's centre of mass."""
        link = link_at(model, place)
        moment = values["along"] * link.along + values["across"] * link.across
        reshape(build, link, lambda now: with_moment(now, moment))

    def _now(self, model: Model, place: Placement) -> tuple[Link, np.ndarray]:
        """The link, and its centre with what the model has of this effect."""
        link = link_at(model, place)
        own = [e.values for e in model.effects if self.sits(e.key, model, place)]
        moment = sum((v["along"] * link.along + v["across"] * link.across for v in own), np.zeros(3))
        return link, link.inertial.centre + moment / link.inertial.mass
