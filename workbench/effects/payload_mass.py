"""A body at the payload site that the model does not contain."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import combinations
from pathlib import Path

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model, load_tree

from .base import WHOLE, Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .links import carrying, leaning
from .motion import Motion
from .parameter import INF, Chart, Parameter, Parameters, Place, Values
from .response import Response

_MASS = Parameter("mass", "kg", example=0.3)
_MOMENTS = tuple(
    Parameter(
        f"moment_{way}",
        "kg*m",
        lower=-INF,
        about=f"mass times distance of the centre from the site, along {way} of the site; may be left out",
        optional=True,
    )
    for way in "xyz"
)
#: Which moments a motion may show, by the name that the shape has.
_OFF_CENTRE = {
    "off_" + "".join(m.name[-1] for m in some): some
    for count in (1, 2, 3)
    for some in combinations(_MOMENTS, count)
}
_NEW = 1e-3  # of a column, that others do not show: less cannot be told in any log


def _form(shape: Values) -> tuple[Parameter, ...]:
    return next((some for name, some in _OFF_CENTRE.items() if name in shape), ())


def _values(coefficients: np.ndarray, shape: Values) -> dict[str, float]:
    return dict(zip([p.name for p in (_MASS, *_form(shape))], map(float, coefficients), strict=True))


def _solved(values: Values) -> tuple[np.ndarray, dict[str, float]]:
    there = [m for m in _MOMENTS if m.name in values]
    shape = {name: 1.0 for name, some in _OFF_CENTRE.items() if list(some) == there}
    return np.array([values["mass"], *(values[m.name] for m in there)]), shape


def _forms(motions: Sequence[Motion], model: Model, place: Place) -> Sequence[Values]:
    """A point at the site; and a body whose centre is off it, as far as the motions show that."""
    del place
    known = np.concatenate([_mass(m, model).ravel() for m in motions])[:, None]
    shown = ""
    for way, name in zip(np.eye(3), "xyz", strict=True):
        column = np.concatenate([_moment(m, model, way).ravel() for m in motions])
        rest = column - known @ np.linalg.lstsq(known, column, rcond=None)[0]
        if np.linalg.norm(rest) > _NEW * np.linalg.norm(column):
            shown, known = shown + name, np.column_stack([known, column])
    return ({}, {f"off_{shown}": 1.0}) if shown else ({},)


def _mass(motion: Motion, model: Model) -> np.ndarray:
    assert model.payload_site is not None
    return -carrying(motion, motion.site(model.payload_site), np.zeros(3))


def _moment(motion: Motion, model: Model, way: np.ndarray) -> np.ndarray:
    assert model.payload_site is not None
    return -leaning(motion, motion.site(model.payload_site), way)


@lru_cache(maxsize=64)
def _turned(serial: Path, site: str) -> np.ndarray:
    """Return how a site is turned in its body (4,), in whatever way its file says that."""
    return np.array(load_tree(serial).compile().site(site).quat)


class PayloadMass(Effect):
    """A rigid body at the payload site, most often a point: torque = -J^T (m a + w' x h + ... - m g).

    J is the site's Jacobian, h the first moment about the site. Beyond that of its mass at its centre the
    body has no inertia: what one holds in a hand has little.
    """

    name = "payload_mass"
    parameters = Parameters(
        _MASS,
        *_MOMENTS,
        chart=Chart(
            (_MASS,), _values, _solved, special={name: (_MASS, *some) for name, some in _OFF_CENTRE.items()}
        ),
        starts=_forms,
    )
    stage = SignalStage.MECHANISM
    locations = WHOLE
    words = Words(
        source="Newton-Euler for a body with a first moment; Lynch and Park, Modern Robotics, Ch. 8",
        shows="extra inertia and weight, as from one mass, on every axis that moves the site",
        reveal="a slow sweep over the whole range (weight), then a fast chirp (inertia)",
        mujoco="native: a body of that mass at the site",
        needs="a place: name a site of the MJCF in [payload], or add one at the end",
    )
    search = Search(frf_signature=FrfSignature.EVEN, basic=True)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Return whether the model names a site that carries it."""
        return model.payload_site is not None

    def site(self, model: Model) -> str | None:
        """Return the payload's site."""
        return model.payload_site

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """Return the torque of 1 kg at the site; off it, also of 1 kg m along each axis of the site."""
        ways = [np.eye(3)[_MOMENTS.index(m)] for m in _form(shape)]
        return Response(np.stack([_mass(motion, model), *(_moment(motion, model, w) for w in ways)]))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """A body at the site; no bigger than a point, but with an inertia that MuJoCo accepts."""
        site = build.links.site(model.payload_site)
        mass, moment = values["mass"], np.array([values.get(m.name, 0.0) for m in _MOMENTS])
        body = site.parent.add_body(pos=site.pos, quat=_turned(model.links[0], site.name))
        body.explicitinertial, body.mass = True, mass
        body.ipos = moment / mass if mass > 0.0 else np.zeros(3)
        body.inertia = np.full(3, max(1e-9 * mass, 1e-14))
