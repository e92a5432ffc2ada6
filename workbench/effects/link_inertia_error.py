"""A link whose inertia about its own centre is not what the model has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model, Placement

from .base import Effect, Search, SignalStage, Words
from .chain import Build
from .corrected import OfBody, added, down_to
from .links import link_at, link_of, own_inertia, reshape, turning
from .motion import Motion
from .parameter import INF, Parameter, Parameters, Place, Values
from .response import Response
from .structure import is_parallelogram

_LEAST = 0.05  # of the model's, that any body of its size keeps


def _own(model: Model, place: Placement) -> float:
    """Return what the file states plus what was added."""
    link = link_at(model, place)
    return own_inertia(link.inertial, link) + added("link_inertia_error", "inertia", model, place)


def _most_less(model: Model, place: Placement) -> float:
    """Return the largest decrease: a twentieth of the model's value stays."""
    return (1.0 - _LEAST) * _own(model, place)


class LinkInertiaError(Effect):
    """More inertia of an axis' link about the parallel to the axis through its centre of mass."""

    name = "link_inertia_error"
    parameters = Parameters(
        Parameter(
            "inertia",
            "kg*m^2",
            lower=-INF,
            about="added to what the model has",
            within=down_to(_most_less),
            example=0.004,
        )
    )
    stage = SignalStage.MECHANISM
    corrects = OfBody(_own, "inertia", called="inertia")
    words = Words(
        source="Newton-Euler; Khalil and Dombre, Modeling, Identification and Control of Robots, Ch. 9",
        shows="torque residual proportional to the link's acceleration, on its axis and those before it, "
        "without weight",
        reveal="fast chirps of this axis and of the ones before it, one after the other",
        mujoco="native: the body's inertia",
        needs="a hinge whose link has a mass and is moved by another axis (otherwise use reflected_inertia); "
        "for a parallelogram, use the linkage's increments",
    )
    search = Search(tier=1)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Return True for a hinge whose body has a mass and is turned by another axis too; otherwise it
        is the rotor's.
        """
        link = link_of(model, key.axis)
        turned = link is not None and link.carried and not link.slides
        return turned and not is_parallelogram(model)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: minus what the inertia needs, per kg m^2."""
        axis = link_at(model, place).axis
        return Response(-turning(motion, place.index, np.outer(axis, axis))[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """The body's inertia; about other axes it follows only as far as a body's has to."""
        link, more = link_at(model, place), values["inertia"]
        about = more * np.outer(link.axis, link.axis)
        reshape(build, link, lambda now: replace(now, tensor=now.tensor + about))
