"""A link whose inertia about its own centre is not what the model has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.models import BodyNumbers, Model, Placement

from .base import INF, Door, Effect, Parameter
from .chain import Build
from .links import link_at, link_of, reshape, turning
from .motion import Motion
from .response import Response
from .structure import is_parallelogram

_LEAST = 0.05  # of the model's, that any body of its size keeps


class LinkInertiaError(Effect):
    """More inertia of an axis' link about the parallel to the axis through its centre of mass."""

    name = "link_inertia_error"
    parameters = (Parameter("inertia", "kg*m^2", lower=-INF, about="added to what the model has"),)
    door = Door.MECHANISM
    on_links = True
    adds_up = True
    tier = 1
    needs = (
        "a hinge whose link has a mass and hangs on another axis, else it is reflected_inertia; of a "
        "parallelogram the linkage's increments say it"
    )
    source = "Newton-Euler; Khalil and Dombre, Modeling, Identification and Control of Robots, Ch. 9"
    shows = "torque residual with the acceleration of the whole link, axes before it included, and no weight"
    reveal = "fast chirps of this axis and of the ones before it, one after the other"
    mujoco = "native: the body's inertia"

    def applies(self, model: Model, key: EffectKey) -> bool:
        """To a hinge whose body has a mass and is turned by another axis too: else it is the rotor's."""
        link = link_of(model, key.axis)
        return link is not None and link.carried and not is_parallelogram(model)

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """One column: minus what the inertia needs, per kg m^2."""
        assert place is not None
        axis = link_at(model, place).axis
        return Response(-turning(motion, place.index, np.outer(axis, axis))[None])

    def bounds(self, model: Model, place: Placement | None) -> tuple[np.ndarray, np.ndarray]:
        """A twentieth of what the model has stays."""
        return np.array([-(1.0 - _LEAST) * self.model_value(model, place)]), np.array([np.inf])

    def model_value(self, model: Model, place: Placement | None) -> float:
        """What the file states, and what was added."""
        assert place is not None
        link = link_at(model, place)
        own = float(link.axis @ link.inertial.tensor @ link.axis)
        return own + sum(e.values["inertia"] for e in model.effects if self.sits(e.key, model, place))

    def in_file(self, model: Model, place: Placement | None, values: Mapping[str, float]) -> BodyNumbers:
        """The body's inertia."""
        assert place is not None
        return BodyNumbers(model.joints[place.index])

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """The body's inertia; about other axes it follows only as far as a body's has to."""
        link, more = link_at(model, place), values["inertia"]
        about = more * np.outer(link.axis, link.axis)
        reshape(build, link, lambda now: replace(now, tensor=now.tensor + about))
