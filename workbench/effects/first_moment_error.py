"""A link whose centre of mass, or mass, is not where the model has it."""

from __future__ import annotations

from functools import partial

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .corrected import OfBody, there
from .links import Link, link_at, link_of, reshape, shifting, with_moment
from .motion import Motion
from .parameter import INF, Parameter, Parameters, Place, Values
from .response import Response
from .structure import is_parallelogram


def _now(model: Model, place: Place) -> tuple[Link, np.ndarray]:
    """The link, and its centre with what the model has of this effect."""
    link = link_at(model, place)
    own = there("first_moment_error", model, place)
    moment = sum((v["along"] * link.along + v["across"] * link.across for v in own), np.zeros(3))
    return link, link.inertial.centre + moment / link.inertial.mass


def _within(which: int, model: Model, place: Place) -> tuple[float, float]:
    """The centre stays within the reach of its link, whichever way."""
    link, centre = _now(model, place)
    own = link.inertial.mass * np.array([link.along, link.across]) @ (centre - link.anchor)
    reach = link.inertial.mass * link.size
    return min(-reach - own[which], 0.0), max(reach - own[which], 0.0)


class FirstMomentError(Effect):
    """Mass times lever of an axis' link is more by `along` (towards the next joint) and `across` that.

    The link keeps its mass and the inertia about its centre; the centre moves by the moment over the mass.
    """

    name = "first_moment_error"
    parameters = Parameters(
        Parameter(
            "along",
            "kg*m",
            lower=-INF,
            within=partial(_within, 0),
            about="added to what the model has",
            example=0.03,
        ),
        Parameter(
            "across",
            "kg*m",
            lower=-INF,
            within=partial(_within, 1),
            about="a quarter turn about the axis from it",
            example=0.0,
        ),
    )
    stage = SignalStage.MECHANISM
    corrects = OfBody(called="first moment")
    words = Words(
        source="base parameters of a link; Khalil and Dombre, Modeling, Identification and Control "
        "of Robots, Ch. 9",
        shows="torque residual a sine of the link's angle to gravity, on its axis and those before it",
        reveal="a slow sweep of this axis over its whole range, the others held; then a fast one",
        mujoco="native: the body's centre of mass",
        needs="a hinge whose link has a mass; of a parallelogram the linkage's increments say it",
    )
    search = Search(frf_signature=FrfSignature.EVEN)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """To a hinge whose body has a mass."""
        return link_of(model, key.axis) is not None and not is_parallelogram(model)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """Two columns: minus what the shifted mass needs, per kg m."""
        link, centre = _now(model, place)
        return Response(
            -np.stack([shifting(motion, place.index, w, centre) for w in (link.along, link.across)])
        )

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """The body's centre of mass."""
        link = link_at(model, place)
        moment = values["along"] * link.along + values["across"] * link.across
        reshape(build, link, lambda now: with_moment(now, moment))
