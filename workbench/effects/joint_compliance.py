"""A spring between motor and link: a belt, a shaft in torsion, a harmonic drive's flexspline."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model, Placement

from .base import Door, Effect, Parameter, Trace
from .chain import Build
from .flexible import (
    can_split,
    free_wind,
    frequencies,
    link_inertia,
    split,
    spring_lack,
    spring_wind,
    stiffest,
    transmitted,
)
from .lacking import refined, share_left
from .motion import Motion
from .response import Response


class JointCompliance(Effect):
    """torque on the link = k (r - q) + d (r' - q'), r the motor's angle, which is logged, q the link's."""

    name = "joint_compliance"
    parameters = (
        Parameter("stiffness", "N*m/rad", lower=1e-3),
        Parameter("damping", "N*m*s/rad"),
    )
    nonlinear = ("stiffness", "damping")
    by_runs = True
    splits = True
    door = Door.MECHANISM
    tier = 1
    locations = ("actuator", "joint")
    needs_the_past = True
    trace = Trace.RESONANCE
    needs = "inertia on both sides: of the drive in [actuators] or as armature, and of the link; once"
    source = "Spong, Modeling and control of elastic joint robots, J. Dyn. Sys. Meas. Control 109, 1987"
    shows = "less inertia above, more below an antiresonance of the links; FRF with a dip and a peak"
    reveal = "a chirp or multisine of this axis up to beyond the resonance"
    mujoco = "native: a joint for the motor, and a tendon with stiffness and damping to the links"

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Where a rotor can be taken off its link, once."""
        return can_split(model, key)

    def guesses(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[tuple[Mapping[str, float], float]]:
        """What the lacking torque asks for, from antiresonances from 4 Hz on, hardly and well damped."""
        assert place is not None
        inertia, _ = link_inertia(motions[0], model, place)
        if inertia <= 0.0:  # a rotor as heavy as all that turns leaves nothing behind it
            return []
        starts = [
            (inertia * w**2, 2.0 * share * inertia * w)
            for w in frequencies(motions, 4.0, 150.0, 10)
            for share in (0.03, 0.3)
        ]
        made = [spring_lack(m, model, place) for m in motions]

        def left(values: np.ndarray) -> np.ndarray:
            return np.concatenate(
                [lack.left(spring_wind(lack.load, lack.step, own, *values)) for lack, own in made]
            )

        found = refined(left, starts)
        share = share_left([lack for lack, _ in made], left(found))
        stiffness, damping = np.minimum(found, stiffest(model, place))
        return [({"stiffness": float(stiffness), "damping": float(damping)}, share)]

    def shapes(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[Mapping[str, float]]:
        """The guesses."""
        return [shape for shape, _ in self.guesses(motions, model, place)]

    def shape_bounds(self, model: Model, place: Placement | None) -> dict[str, tuple[float, float]]:
        """Up to what is as good as rigid."""
        top = stiffest(model, place)
        return {"stiffness": (1e-3, top), "damping": (0.0, top)}

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """No free coefficient: what the links do not feel of the motor's motion, as the spring winds up."""
        assert place is not None
        inertia, column = link_inertia(motion, model, place)
        torque = transmitted(motion, model, place)
        moved = torque - torque[0]  # from rest, wound up by the weights; `free_responses` say the rest
        wind = spring_wind(moved, motion.step, inertia, shape["stiffness"], shape["damping"])
        return Response(np.zeros((0, *motion.position.shape)), offset=column * wind[:, None])

    def free_responses(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> np.ndarray:
        """How a spring unwinds that was wound up, or winding, at the first row."""
        assert place is not None
        inertia, column = link_inertia(motion, model, place)
        wind = free_wind(len(column), motion.step, inertia, shape["stiffness"], shape["damping"])
        return column[:, :, None] * wind[:, None, :]

    def least(self, shape: Mapping[str, float]) -> np.ndarray:
        """Of the damping, a thousandth of what makes a spring on a rotor of 0.01 kg m^2 stop ringing."""
        return np.array([1e-6, 1e-3 * np.sqrt(0.01 * shape["stiffness"])])

    def reach(self, shape: Mapping[str, float]) -> dict[str, float]:
        """Half the stiffness; damping by as much as a lightly damped spring has."""
        damping = max(0.5 * shape["damping"], 0.02 * np.sqrt(0.01 * shape["stiffness"]))
        return {"stiffness": 0.5 * shape["stiffness"], "damping": float(damping)}

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """A joint for the motor and a tendon to the links."""
        assert place is not None
        split(build, model, place, values["stiffness"], values["damping"])
