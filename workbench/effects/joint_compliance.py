"""A spring between motor and link: a belt, a shaft in torsion, a harmonic drive's flexspline."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.models import Model

from .base import FrfSignature, Search, Words
from .chain import Build
from .compliance import Compliance
from .flexible import (
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
from .parameter import Parameter, Parameters, Place, Values
from .response import Response


class JointCompliance(Compliance):
    """torque on the link = stiffness * (r - q) + damping * (r' - q'), r the motor's angle, which is logged,
    and q the link's.
    """

    name = "joint_compliance"
    parameters = Parameters(
        Parameter(
            "stiffness",
            "N*m/rad",
            lower=1e-3,
            example=40.0,
            linear=False,
            within=lambda model, place: (1e-3, stiffest(model, place)),
            reach=lambda shape: 0.5 * shape["stiffness"],
            least=1e-6,
        ),
        Parameter(
            "damping",
            "N*m*s/rad",
            example=0.05,
            linear=False,
            within=lambda model, place: (0.0, stiffest(model, place)),
            reach=lambda shape: max(0.5 * shape["damping"], 0.02 * _critical(shape)),
            least=lambda shape: 1e-3 * _critical(shape),
        ),
    )
    locations = ("actuator", "joint")
    words = Words(
        source="Spong, Modeling and control of elastic joint robots, J. Dyn. Sys. Meas. Control 109, 1987",
        shows="FRF with an anti-resonance and a resonance; more inertia below the anti-resonance, less above",
        reveal="a chirp or multisine of this axis up to beyond the resonance",
        mujoco="native: a joint for the motor, and a tendon with stiffness and damping to the links",
        needs="inertia on both sides: of the drive in [actuators] or as armature, and of the link; once",
    )
    search = Search(frf_signature=FrfSignature.RESONANCE)
    spring = True

    def initial_values(
        self, motions: Sequence[Motion], model: Model, place: Place
    ) -> Sequence[tuple[Values, float]]:
        """What the lacking torque asks for, from antiresonances from 4 Hz on, hardly and well damped."""
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

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """No free coefficient: what the links do not feel of the motor's motion, as the spring winds up."""
        inertia, column = link_inertia(motion, model, place)
        torque = transmitted(motion, model, place)
        moved = torque - torque[0]  # from rest, wound up by the weights; `free_responses` say the rest
        wind = spring_wind(moved, motion.step, inertia, shape["stiffness"], shape["damping"])
        return Response(np.zeros((0, *motion.position.shape)), offset=column * wind[:, None])

    def free_responses(self, motion: Motion, model: Model, place: Place, shape: Values) -> np.ndarray:
        """How a spring unwinds that was wound up, or winding, at the first row."""
        inertia, column = link_inertia(motion, model, place)
        wind = free_wind(len(column), motion.step, inertia, shape["stiffness"], shape["damping"])
        return column[:, :, None] * wind[:, None, :]

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """A joint for the motor and a tendon to the links."""
        split(build, model, place, values["stiffness"], values["damping"])


def _critical(shape: Values) -> float:
    """Damping that makes such a spring on a rotor of 0.01 kg m^2 stop ringing, about [N m s/rad]."""
    return float(np.sqrt(0.01 * shape["stiffness"]))
