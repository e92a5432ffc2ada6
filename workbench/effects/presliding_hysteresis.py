"""Dahl friction: a spring before it slides, Coulomb friction once it does."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core.compiled import compiled
from workbench.models import Model

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build, HysteresisTerm
from .motion import Motion
from .parameter import Chart, Parameter, Parameters, Place, Unknown, Values
from .response import Response, single


def _distances(motions: Sequence[Motion], model: Model, place: Place) -> np.ndarray:
    """Presliding distances from a ten-thousandth of the whole way to all of it."""
    way = max(float(np.ptp(m.along(place)[0])) for m in motions) + 1e-9
    return 1.0 / (way * np.geomspace(1e-4, 1.0, 9))


def _values(coefficients: np.ndarray, shape: Values) -> dict[str, float]:
    """Stiffness is the ratio times the torque."""
    torque = float(coefficients[0])
    return {"torque": torque, "stiffness": shape["ratio"] * torque}


def _solved(values: Values) -> tuple[np.ndarray, dict[str, float]]:
    """Torque, and stiffness over torque."""
    torque = values["torque"]
    return np.array([torque]), {"ratio": values["stiffness"] / max(torque, 1e-12)}


#: Stiffness over torque: one over the distance on which friction builds up.
_RATIO = Unknown("ratio", lower=1e-3, upper=1e9, linear=False, starts=_distances)
_DISTANCE = Chart((Unknown("torque"), _RATIO), _values, _solved)


def _slides(motions: Sequence[Motion], place: Place, values: Values) -> bool:
    """Where it slides: what only ever winds up is a spring."""
    way = max(float(np.ptp(m.along(place)[0])) for m in motions)
    return values["stiffness"] * way > values["torque"]


def _worn(values: Values, position_noise: float, torque_noise: float) -> float:
    """Dither within the presliding distance f / k wears the memory off, as a stiffer spring would."""
    share = position_noise * values["stiffness"] / max(values["torque"], 1e-12)
    return 1.5 * min(share, 1.0) * values["stiffness"]


class PreslidingHysteresis(Effect):
    """torque = -f z, dz/dt = (stiffness / f) w (1 - sign(w) z), f the parameter `torque`."""

    name = "presliding_hysteresis"
    parameters = Parameters(
        Parameter("torque", "N*m", example=0.25),
        Parameter("stiffness", "N*m/rad", lower=1e-6, blur=_worn, told=_slides, example=10.0),
        chart=_DISTANCE,
    )
    stage = SignalStage.FRICTION
    locations = ("actuator", "joint")
    words = Words(
        source="Dahl, A solid friction model, Aerospace Corp. TOR-0158(3107-18)-1, 1968",
        shows="torque residual forms a loop over position that closes after each reversal, alike at every "
        "speed",
        reveal="small slow reversals within the presliding distance, then larger ones",
        mujoco="state of a tendon's spring, step by step; as plain MJCF a spring with `springyield` "
        "(MuJoCo 4), "
        "which yields at once, whereas this effect yields gradually",
    )
    search = Search(contains=("coulomb_friction",), frf_signature=FrfSignature.ODD, hidden_state=True)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: minus the state that the motion winds up."""
        position, _, _ = motion.along(place)
        return Response(single(place, -wound(position, shape["ratio"]), motion)[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """A spring of its own on the axis's coordinate, whose stiffness and rest follow the state."""
        if values["torque"] == 0.0:  # no friction: the share of a stiffness of nothing is no number
            return
        name = f"hysteresis:{len(build.chain.hysteresis)}"
        tendon = build.spec.add_tendon(name=name)
        for joint, coefficient in zip(model.joints, place.row, strict=True):
            if coefficient:
                tendon.wrap_joint(joint, float(coefficient))
        tendon.stiffness[0] = values["stiffness"]
        tendon.springyield = values["torque"] / values["stiffness"]
        term = HysteresisTerm(name, place.tendon, values["torque"], values["stiffness"])
        build.chain.hysteresis.append(term)


@compiled()
def wound(position: np.ndarray, ratio: float) -> np.ndarray:
    """Return state z (N,) along positions (N,), relaxed at the first, exact without reversals between
    rows.
    """
    state, out = 0.0, np.zeros(len(position))
    for k in range(1, len(position)):
        moved = position[k] - position[k - 1]
        side = np.sign(moved)
        state = side - (side - state) * np.exp(-ratio * abs(moved))
        out[k] = state
    return out
