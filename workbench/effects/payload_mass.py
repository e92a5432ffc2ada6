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
_OFF = "mass times distance of the centre from the site, along {} of the site; may be left out"
_MOMENTS = (
    Parameter("moment_x", "kg*m", lower=-INF, about=_OFF.format("x"), optional=True),
    Parameter("moment_y", "kg*m", lower=-INF, about=_OFF.format("y"), optional=True),
    Parameter("moment_z", "kg*m", lower=-INF, about=_OFF.format("z"), optional=True),
)
_INERTIA = Parameter(
    "inertia", "kg*m^2", about="about the centre, the same in every direction; may be left out", optional=True
)
_BODY = (*_MOMENTS, _INERTIA)
#: Which of them a motion shows, by the name that the shape has.
_FORMS = {
    "body_" + "".join(str(_BODY.index(p)) for p in some): some
    for count in range(1, len(_BODY) + 1)
    for some in combinations(_BODY, count)
}
_NEW = 1e-3  # of a column, that others do not show: less cannot be told in any log


def _beside_mass(shape: Values) -> tuple[Parameter, ...]:
    return next((some for name, some in _FORMS.items() if name in shape), ())


def _values(coefficients: np.ndarray, shape: Values) -> dict[str, float]:
    names = [p.name for p in (_MASS, *_beside_mass(shape))]
    return dict(zip(names, map(float, coefficients), strict=True))


def _solved(values: Values) -> tuple[np.ndarray, dict[str, float]]:
    there = tuple(p for p in _BODY if p.name in values)
    shape = {name: 1.0 for name, some in _FORMS.items() if some == there}
    return np.array([values["mass"], *(values[p.name] for p in there)]), shape


def _shapes(motions: Sequence[Motion], model: Model, place: Place) -> Sequence[Values]:
    """A point at the site; and a body with a centre and an inertia, as far as the motions show these."""
    del place
    known = np.concatenate([_column(_MASS, m, model).ravel() for m in motions])[:, None]
    shown: list[Parameter] = []
    for parameter in _BODY:
        column = np.concatenate([_column(parameter, m, model).ravel() for m in motions])
        rest = column - known @ np.linalg.lstsq(known, column, rcond=None)[0]
        if np.linalg.norm(rest) > _NEW * np.linalg.norm(column):
            shown, known = [*shown, parameter], np.column_stack([known, column])
    return ({}, *({name: 1.0} for name, some in _FORMS.items() if list(some) == shown))


def _column(parameter: Parameter, motion: Motion, model: Model) -> np.ndarray:
    """Torque (N, n) that 1 kg at the site takes off the drives; 1 kg m along an axis of it; 1 kg m^2."""
    assert model.payload_site is not None
    site = motion.site(model.payload_site)
    if parameter is _MASS:
        return -carrying(motion, site, np.zeros(3))
    if parameter is _INERTIA:  # a ball: its momentum is along its speed, whatever its posture
        return -np.einsum("kij,ki->kj", site.turn, site.spin_up)
    return -leaning(motion, site, np.eye(3)[_MOMENTS.index(parameter)])


@lru_cache(maxsize=64)
def _turned(serial: Path, site: str) -> np.ndarray:
    """Return how a site is turned in its body (4,), in whatever way its file says that."""
    return np.array(load_tree(serial).compile().site(site).quat)


class PayloadMass(Effect):
    """A point mass at the payload site: torque = -mass * J^T (d(J w)/dt - g), J the site's Jacobian.

    Where moments or an inertia are given too, it is a body whose centre is off the site by the moments
    divided by the mass, and whose inertia about its centre is the same in every direction.
    """

    name = "payload_mass"
    parameters = Parameters(
        _MASS,
        *_BODY,
        chart=Chart(
            (_MASS,), _values, _solved, special={name: (_MASS, *some) for name, some in _FORMS.items()}
        ),
        starts=_shapes,
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
        """One column: the torque of a mass of 1 kg; of a body one more for each further number."""
        parameters = (_MASS, *_beside_mass(shape))
        return Response(np.stack([_column(p, motion, model) for p in parameters]))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """A body at the site; if no bigger than a point, then with an inertia that MuJoCo accepts."""
        site = build.links.site(model.payload_site)
        mass, moment = values["mass"], np.array([values.get(m.name, 0.0) for m in _MOMENTS])
        body = site.parent.add_body(pos=site.pos, quat=_turned(model.links[0], site.name))
        body.explicitinertial, body.mass = True, mass
        body.ipos = moment / mass if mass > 0.0 else np.zeros(3)
        body.inertia = np.full(3, max(values.get("inertia", 0.0), 1e-9 * mass, 1e-14))
