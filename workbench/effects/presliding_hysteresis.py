"""Dahl friction: a spring before it slides, Coulomb friction once it does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numba import njit

from workbench.models import Model, Placement

from .base import INF, Door, Effect, Parameter, Trace
from .chain import Build, HysteresisTerm
from .motion import Motion
from .response import Response, single


class PreslidingHysteresis(Effect):
    """torque = -f z, dz/dt = (k/f) w (1 - sign(w) z)."""

    name = "presliding_hysteresis"
    parameters = (Parameter("torque", "N*m"), Parameter("stiffness", "N*m/rad", lower=1e-6))
    nonlinear = ("ratio",)  # stiffness over torque: one over the distance on which friction builds up
    door = Door.FRICTION
    depends_on = ("speed",)
    tier = 1
    contains = ("coulomb_friction",)
    locations = ("actuator", "joint")
    of_a_make = True
    needs_the_past = True
    trace = Trace.ODD
    source = "Dahl, A solid friction model, Aerospace Corp. TOR-0158(3107-18)-1, 1968"
    shows = "torque residual a loop over position that closes after each reversal, alike at every speed"
    reveal = "small slow reversals within the presliding distance, then larger ones"
    mujoco = (
        "state of a tendon's spring, step by step; as plain MJCF a spring with `springyield` (MuJoCo 4), "
        "which yields at once where this one does by and by"
    )

    def shapes(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[Mapping[str, float]]:
        """Presliding distances from a ten-thousandth of the whole way to all of it."""
        assert place is not None
        positions = [m.along(place)[0] for m in motions]
        way = max(float(np.ptp(p)) for p in positions) + 1e-9
        return [{"ratio": float(1.0 / d)} for d in way * np.geomspace(1e-4, 1.0, 9)]

    def shape_bounds(self, model: Model, place: Placement | None) -> dict[str, tuple[float, float]]:
        """Any distance."""
        return {"ratio": (1e-3, 1e9)}

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """One column: minus the state that the motion winds up."""
        assert place is not None
        position, _, _ = motion.along(place)
        return Response(single(place, -wound(position, shape["ratio"]), motion)[None])

    def identifiable(
        self, motions: Sequence[Motion], place: Placement | None, values: Mapping[str, float]
    ) -> bool:
        """Where it slides: what only ever winds up is a spring."""
        assert place is not None
        positions = [m.along(place)[0] for m in motions]
        way = max(float(np.ptp(p)) for p in positions)
        return values["stiffness"] * way > values["torque"]

    def bounds(self, model: Model, place: Placement | None) -> tuple[np.ndarray, np.ndarray]:
        """No negative friction."""
        return np.zeros(1), np.full(1, INF)

    def to_parameters(self, coefficients: np.ndarray, shape: Mapping[str, float]) -> dict[str, float]:
        """Stiffness is the ratio times the torque."""
        torque = float(coefficients[0])
        return {"torque": torque, "stiffness": shape["ratio"] * torque}

    def to_coefficients(self, values: Mapping[str, float]) -> tuple[np.ndarray, dict[str, float]]:
        """Torque, and stiffness over torque."""
        torque = values["torque"]
        return np.array([torque]), {"ratio": values["stiffness"] / max(torque, 1e-12)}

    def blur(
        self, values: Mapping[str, float], position_noise: float, torque_noise: float
    ) -> dict[str, float]:
        """Dither within the presliding distance f / k wears the memory off, as a stiffer spring would."""
        share = position_noise * values["stiffness"] / max(values["torque"], 1e-12)
        return {"stiffness": 1.5 * min(share, 1.0) * values["stiffness"]}

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """A spring of its own on the axis's coordinate, whose stiffness and rest follow the state."""
        assert place is not None
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


@njit(cache=True)
def wound(position: np.ndarray, ratio: float) -> np.ndarray:
    """State z (N,) along positions (N,), relaxed at the first, exact for a way without reversals between."""
    state, out = 0.0, np.zeros(len(position))
    for k in range(1, len(position)):
        moved = position[k] - position[k - 1]
        side = np.sign(moved)
        state = side - (side - state) * np.exp(-ratio * abs(moved))
        out[k] = state
    return out
