"""A link whose inertia about its own centre is not what the model has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.models import Inertial, Model, Placement, rotors

from .base import Effect, Search, SignalStage, Words
from .chain import Build
from .corrected import OfBody, added, down_to
from .links import Link, in_proportion, link_at, link_of, own_inertia, reshape, turning
from .motion import Motion
from .parameter import INF, Chart, Parameter, Parameters, Place, Values
from .response import Response
from .structure import is_parallelogram

_LEAST = 0.05  # of the model's, that any body of its size keeps
_SAME = 1e-6  # of the largest torque: two that are one


def _own(model: Model, place: Placement) -> float:
    """Return what the file states plus what was added."""
    link = link_at(model, place)
    return own_inertia(link.inertial, link) + added("link_inertia_error", "inertia", model, place)


def _most_less(model: Model, place: Placement) -> float:
    """Return the largest decrease: a twentieth of the model's value stays."""
    return (1.0 - _LEAST) * _own(model, place)


_INERTIA = Parameter(
    "inertia",
    "kg*m^2",
    lower=-INF,
    about="added to what the model has",
    within=down_to(_most_less),
    example=0.004,
)
_PROPORTION = Parameter(
    "proportion",
    "1",
    upper=1.0,
    about="how much of it the other directions get, 1: the same proportion; left out: nothing",
    optional=True,
)


def _values(coefficients: np.ndarray, shape: Values) -> dict[str, float]:
    return {"inertia": float(coefficients[0]), **shape}


def _solved(values: Values) -> tuple[np.ndarray, dict[str, float]]:
    return np.array([values["inertia"]]), {k: v for k, v in values.items() if k != "inertia"}


def _forms(motions: Sequence[Motion], model: Model, place: Place) -> Sequence[Values]:
    """The inertia about the axis alone, and all of it in proportion, where a motion tells them apart.

    All of it does nearly what rotors of several drives do. A file that states no rotor lacks it: that is
    simpler. Where it states them, one inertia that is wrong is simpler than several rotors that are.
    """
    link = link_at(model, place)
    if not rotors(model)[0][place.index] > 0.0:
        return ({},)
    alone, whole = (_changed(link.inertial, link, 1.0, p) - link.inertial.tensor for p in (0.0, 1.0))
    needed = [(turning(m, place.index, alone), turning(m, place.index, whole)) for m in motions]
    same = all(np.allclose(a, b, rtol=0.0, atol=_SAME * np.abs(a).max(initial=0.0)) for a, b in needed)
    return ({},) if same else ({}, {"proportion": 1.0})


def _changed(inertial: Inertial, link: Link, more: float, proportion: float) -> np.ndarray:
    """Return the inertia (3, 3) of a link with `more` about its axis, and this proportion about others."""
    alone = inertial.tensor + more * np.outer(link.axis, link.axis)
    return (1.0 - proportion) * alone + proportion * in_proportion(inertial, link, more)


class LinkInertiaError(Effect):
    """An axis' link has more inertia, about the line through its centre of mass parallel to the axis.

    A search tries two causes: this moment of inertia alone, or all of the inertia in proportion.
    """

    name = "link_inertia_error"
    parameters = Parameters(
        _INERTIA,
        _PROPORTION,
        chart=Chart((_INERTIA,), _values, _solved, special={"proportion": (_INERTIA,)}),
        starts=_forms,
    )
    stage = SignalStage.MECHANISM
    corrects = OfBody(_own, "inertia", called="inertia")
    words = Words(
        source="Newton-Euler; Khalil and Dombre, Modeling, Identification and Control of Robots, Ch. 9",
        shows="torque residual proportional to the link's acceleration, on its axis and those before it, "
        "without weight",
        reveal="fast chirps of this axis and of the ones before it, one after the other",
        mujoco="native: the body's inertia",
        needs="a hinge whose link has a mass; for a parallelogram, use the linkage's increments",
    )
    search = Search(tier=1)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Return True for a hinge whose body has a mass.

        If no other axis turns the body, a rotor looks the same, as far as it can be so large or small.
        """
        link = link_of(model, key.axis)
        return link is not None and not link.slides and not is_parallelogram(model)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: minus what the inertia needs, per kg m^2."""
        link = link_at(model, place)
        more = _changed(link.inertial, link, 1.0, shape.get("proportion", 0.0)) - link.inertial.tensor
        return Response(-turning(motion, place.index, more)[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """The body's inertia; about other axes it follows only as far as a body's has to."""
        link, proportion = link_at(model, place), values.get("proportion", 0.0)
        reshape(
            build,
            link,
            lambda now: replace(now, tensor=_changed(now, link, values["inertia"], proportion)),
        )
