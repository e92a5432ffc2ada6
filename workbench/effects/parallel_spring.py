"""A spring beside the drive or across the pin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.models import Model, Placement, springs

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .corrected import AtJoint, added, down_to
from .motion import Motion
from .parameter import INF, Chart, Parameter, Parameters, Place, Unknown, Values
from .response import Response, single

_FAR = 10.0  # spans of the motion: the torque of a spring that rests beyond hardly changes


def _values(coefficients: np.ndarray, shape: Values) -> dict[str, float]:
    """Stiffness, and the rest position where its torque vanishes."""
    stiffness, moment = map(float, coefficients)
    return {"stiffness": stiffness, "rest": moment / stiffness if abs(stiffness) > 1e-12 else 0.0}


def _solved(values: Values) -> tuple[np.ndarray, dict[str, float]]:
    """k and k q0."""
    return np.array([values["stiffness"], values["stiffness"] * values["rest"]]), {}


def _own(model: Model, place: Placement) -> float:
    """What the model states of the drive's own, and what was added."""
    own = float(springs(model)[place.index]) if place.location == "actuator" else 0.0
    return own + added("parallel_spring", "stiffness", model, place)


_STIFF = Unknown("stiffness", within=down_to(_own))
_MOMENT = Chart((_STIFF, Unknown("moment", lower=-INF)), _values, _solved)


def _rests_near(motions: Sequence[Motion], place: Place, values: Values) -> bool:
    """Where it does not rest so far away that it is a constant torque."""
    positions = np.concatenate([m.along(place)[0] for m in motions])
    return bool(abs(values["rest"] - positions.mean()) < _FAR * np.ptp(positions))


class ParallelSpring(Effect):
    """torque = -stiffness * (q - rest)."""

    name = "parallel_spring"
    parameters = Parameters(
        Parameter(
            "stiffness", "N*m/rad", about="added to what the model has", within=down_to(_own), example=1.5
        ),
        Parameter("rest", "rad", lower=-INF, example=0.3),
        chart=_MOMENT,
    )
    stage = SignalStage.MECHANISM
    locations = ("actuator", "joint")
    corrects = AtJoint("stiffness", "stiffness", _own, rest="rest", called="stiffness")
    words = Words(
        source="Hooke 1678; parallel elastic actuation",
        shows="torque residual linear in position at every speed; FRF magnitude is wrong at low frequency",
        reveal="a slow sweep over the widest range of positions",
        mujoco="native: stiffness of the axis's tendon",
    )
    search = Search(
        differs=_rests_near,
        contains=("torque_bias",),
        depends_on=("position",),
        frf_signature=FrfSignature.EVEN,
        tier=0,
    )

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """Two columns: minus the position, and one; the coefficients are k and k q0."""
        position, _, _ = motion.along(place)
        rows = (-position, np.ones_like(position))
        return Response(np.stack([single(place, row, motion) for row in rows]))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Stiffness of the tendon, negative where a joint has too much; a second spring adds to a first."""
        tendon = build.spec.tendon(place.tendon)
        before = float(tendon.stiffness[0])
        rest = float(tendon.springlength[0]) if before else 0.0
        after = before + values["stiffness"]
        if after:
            tendon.stiffness[0] = after
            tendon.springlength = np.full(2, (before * rest + values["stiffness"] * values["rest"]) / after)
