"""A link whose centre of mass, or mass, differs from the model's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from workbench.core import EffectKey
from workbench.models import Inertial, Model

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .corrected import OfBody, there
from .links import (
    Link,
    carrying,
    in_proportion,
    link_at,
    link_of,
    own_inertia,
    reshape,
    shifting,
    turning,
    with_moment,
)
from .motion import Motion
from .parameter import INF, Chart, Parameter, Parameters, Place, Unknown, Values
from .response import Response
from .structure import is_parallelogram

_LEAST = 0.05  # of the model's mass, that any link keeps


def _changed(inertial: Inertial, link: Link, values: Values) -> Inertial:
    """Return the link with this effect: mass and inertia first, then the rest of the moment."""
    mass, more = values.get("mass", 0.0), values.get("inertia", 0.0)
    moment = values["along"] * link.along + values["across"] * link.across
    heavier = replace(inertial, mass=inertial.mass + mass, tensor=in_proportion(inertial, link, more))
    return with_moment(heavier, moment - mass * _lever(inertial, link))


def _lever(inertial: Inertial, link: Link) -> np.ndarray:
    """Return the vector from the hinge to the centre, perpendicular to the axis, (3,)."""
    arm = inertial.centre - link.anchor
    return arm @ link.along * link.along + arm @ link.across * link.across


def _now(model: Model, place: Place) -> Link:
    """Return the link with the model's share of this effect."""
    link = link_at(model, place)
    for values in there("first_moment_error", model, place):
        link = replace(link, inertial=_changed(link.inertial, link, values))
    return link


def _within(which: int, model: Model, place: Place) -> tuple[float, float]:
    """Return whether the centre stays within the reach of its link, in every direction."""
    link = _now(model, place)
    way = (link.along, link.across)[which]
    own = link.inertial.mass * float(way @ _lever(link.inertial, link))
    reach = link.inertial.mass * link.size
    return min(-reach - own, 0.0), max(reach - own, 0.0)


def _mass(model: Model, place: Place) -> float:
    return _now(model, place).inertial.mass


_ALONG = Parameter(
    "along",
    "kg*m",
    lower=-INF,
    within=partial(_within, 0),
    about="towards the next joint; added to what the model has",
    example=0.03,
)
_ACROSS = Parameter(
    "across",
    "kg*m",
    lower=-INF,
    within=partial(_within, 1),
    about="perpendicular to that and to the axis",
    example=0.0,
)


def _lighter(model: Model, place: Place) -> tuple[float, float]:
    """Return by how much the mass may change."""
    return -(1.0 - _LEAST) * _mass(model, place), INF


def _slimmer(model: Model, place: Place) -> tuple[float, float]:
    """Return by how much the inertia may change."""
    link = _now(model, place)
    return -(1.0 - _LEAST) * own_inertia(link.inertial, link), INF


_MASS = Parameter(
    "mass",
    "kg",
    lower=-INF,
    within=_lighter,
    about="added to the link's; may be left out: the mass stays, the centre moves",
    optional=True,
)
_INERTIA = Parameter(
    "inertia",
    "kg*m^2",
    lower=-INF,
    within=_slimmer,
    about="added to the link's about its centre, along its axis; about others in proportion; may be left out",
    optional=True,
)


def _values(coefficients: np.ndarray, shape: Values) -> dict[str, float]:
    """Both moments; of more mass at a centre all three, and the inertia that it brings."""
    if "lever" not in shape:
        along, across = map(float, coefficients)
        return {"along": along, "across": across}
    (mass,) = map(float, coefficients)
    values = {"along": mass * shape["lever"], "across": mass * shape["aside"], "mass": mass}
    return values | ({"inertia": mass * shape["gyration"]} if "gyration" in shape else {})


def _solved(values: Values) -> tuple[np.ndarray, dict[str, float]]:
    mass = values.get("mass", 0.0)
    if not mass:
        return np.array([values["along"], values["across"]]), {}
    shape = {"lever": values["along"] / mass, "aside": values["across"] / mass}
    return np.array([mass]), shape | ({"gyration": values["inertia"] / mass} if "inertia" in values else {})


def _forms(motions: Sequence[Motion], model: Model, place: Place) -> Sequence[Values]:
    """A centre elsewhere; more mass where it is, if that shows; and the same with more inertia.

    A mass that was typed wrong leaves the inertia as it is; one that was computed from the wrong density, or
    from the wrong size, takes the inertia with it. Of what slides the mass alone. Where no torque is known,
    a motion shows only what things are to one another, and a mass would set the measure of all of it.
    """
    link = _now(model, place)
    undriven = len(motions) > 0 and not any(np.any(m.torque) for m in motions)
    if undriven or not (link.mass_alone or link.slides):
        return ({},)
    lever = _lever(link.inertial, link)
    heavier = {"lever": float(lever @ link.along), "aside": float(lever @ link.across)}
    if link.slides:
        return (heavier,)
    return {}, heavier, heavier | {"gyration": own_inertia(link.inertial, link) / link.inertial.mass}


class FirstMomentError(Effect):
    """The first moment (mass times centre) of an axis' link is larger by `along` and `across`.

    Without `mass` the link keeps its mass and the inertia about its centre, and the centre moves by the
    moment divided by the mass. A search tries two causes: a wrong centre, or a wrong mass at the stated
    centre, whose inertia stays or grows in proportion.
    """

    name = "first_moment_error"
    parameters = Parameters(
        _ALONG,
        _ACROSS,
        _MASS,
        _INERTIA,
        chart=Chart(
            (_ALONG, _ACROSS),
            _values,
            _solved,
            special={"lever": (Unknown("mass", within=_lighter),)},
        ),
        starts=_forms,
    )
    stage = SignalStage.MECHANISM
    corrects = OfBody(called="first moment", special={"mass": OfBody(_mass, "mass", called="mass")})
    words = Words(
        source="base parameters of a link; Khalil and Dombre, Modeling, Identification and Control "
        "of Robots, Ch. 9",
        shows="torque residual like the link's weight and acceleration, on its axis and those before it",
        reveal="a slow sweep of this axis over its whole range, the others held; then a fast one",
        mujoco="native: the body's centre of mass, its mass and inertia",
        needs="a link that has a mass; for a parallelogram, use the linkage's increments",
    )
    search = Search(frf_signature=FrfSignature.EVEN)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Return True for a body that has a mass.

        Of one that slides first, and level, a rotor looks the same, as far as it can be so large or small.
        """
        return link_of(model, key.axis) is not None and not is_parallelogram(model)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """Two columns: minus what the shifted mass needs, per kg m; or one, per kg of mass at a lever."""
        link, index = _now(model, place), place.index
        shifts = [shifting(motion, index, w, link.inertial.centre) for w in (link.along, link.across)]
        if "lever" not in shape:
            return Response(-np.stack(shifts))
        own = _lever(link.inertial, link)
        off = shape["lever"] - own @ link.along, shape["aside"] - own @ link.across
        need = (
            carrying(motion, motion.link(index), link.inertial.centre)
            + off[0] * shifts[0]
            + off[1] * shifts[1]
        )
        if "gyration" in shape:
            more = in_proportion(link.inertial, link, shape["gyration"]) - link.inertial.tensor
            need = need + turning(motion, index, more)
        return Response(-need[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """The body's mass and centre of mass."""
        link = link_at(model, place)
        reshape(build, link, lambda now: _changed(now, link, values))
