"""Play between motor and link: worn teeth, keys, couplings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model, Placement

from .base import Door, Effect, Parameter, Response
from .chain import Build
from .flexible import can_split, frequencies, link_inertia, split, stiffest, transmitted
from .lacking import explains_most
from .motion import Motion

_RELATIVE_DAMPING = 0.05  # of the contact, in the screening only, where the links' path is not fed back
_TRIED = 4


class Backlash(Effect):
    """torque on the link = k dead(r - q), zero for |r - q| < gap/2; the motor's angle r is logged."""

    name = "backlash"
    parameters = (
        Parameter("gap", "rad", about="all the play, from one flank to the other"),
        Parameter("stiffness", "N*m/rad", lower=1e-3, about="of either flank"),
    )
    nonlinear = ("gap", "stiffness")
    by_runs = True
    splits = True
    door = Door.MECHANISM
    tier = 1
    contains = ("joint_compliance",)
    locations = ("actuator", "joint")
    source = "Nordin and Gutman, Controlling mechanical systems with backlash, Automatica 38(10), 2002"
    shows = "torque residual in bursts where the transmitted torque changes sign; small limit cycles"
    reveal = "slow reversals with little load on the axis, and a sweep of small amplitude"
    mujoco = "native: a joint for the motor, and a tendon to the links whose spring has a dead band"

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Where a rotor can be taken off its link, once."""
        return can_split(model, key)

    def shapes(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[Mapping[str, float]]:
        """Gaps and stiffnesses of which the lacking torque shows most."""
        assert place is not None
        inertia, _ = link_inertia(motions[0], place.index)
        way = max(float(np.ptp(m.position[:, place.index])) for m in motions) + 1e-9
        choices = [
            {"gap": float(gap), "stiffness": float(inertia * rate**2)}
            for gap in way * np.geomspace(3e-4, 0.1, 9)
            for rate in frequencies(motions, 6.0, 100.0, 11)
        ]
        gaps, stiffnesses = (np.array([c[name] for c in choices]) for name in ("gap", "stiffness"))
        made = [_freed(m, model, place.index, gaps, stiffnesses) for m in motions]
        return [choices[k] for k in explains_most(motions, model, made)[:_TRIED]]

    def shape_bounds(self, model: Model, place: Placement | None) -> dict[str, tuple[float, float]]:
        """Up to what is as good as rigid."""
        return {"gap": (0.0, 1.0), "stiffness": (1e-3, stiffest(model, place))}

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """No free coefficient: what the links do not feel of the motor's motion while they cross the gap."""
        assert place is not None
        gap, stiffness = np.array([shape["gap"]]), np.array([shape["stiffness"]])
        freed = _freed(motion, model, place.index, gap, stiffness)[0]
        return Response(np.zeros((0, *motion.position.shape)), offset=freed)

    def least(self, shape: Mapping[str, float]) -> np.ndarray:
        """Less makes a difference to when a flank is met, not to where."""
        return np.array([1e-5, 1e-3])

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """A joint for the motor and a tendon with a dead band to the links."""
        assert place is not None
        split(build, model, place, values["stiffness"], 0.0, values["gap"])


def _freed(motion: Motion, model: Model, index: int, gap: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
    """Torque (C, N, n) that links behind C gaps need less than rigid ones, along a motion of the motor.

    The wind d between motor and links obeys inertia d'' + k dead(d) = torque, d small, from the middle of
    the gap; semi-implicit Euler, in steps that follow the stiffest contact.
    """
    inertia, column = link_inertia(motion, index)
    torque = transmitted(motion, model, index)
    many = int(np.ceil(motion.step * np.sqrt(stiffness.max() / inertia) / 0.3))
    h, half = motion.step / many, 0.5 * gap
    damping = 2.0 * _RELATIVE_DAMPING * np.sqrt(stiffness * inertia)
    wind, rate = np.zeros_like(gap), np.zeros_like(gap)
    out = np.empty((len(torque), len(gap)))
    for row, load in enumerate(torque.tolist()):
        before = rate
        for _ in range(many):
            into = wind - np.clip(wind, -half, half)
            rate = rate + h / inertia * (load - stiffness * into - np.where(into != 0.0, damping * rate, 0.0))
            wind = wind + h * rate
        out[row] = (rate - before) / motion.step
    return out.T[:, :, None] * column
