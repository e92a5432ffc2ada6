"""Play between motor and link: worn teeth, keys, couplings."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.models import Model

from .base import FrfSignature, Search, Words
from .chain import Build
from .compliance import Compliance
from .flexible import frequencies, link_inertia, split, stiffest
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .passage import Passage, best_gap, foresees, left_by
from .response import Response
from .setting import FLANK_RETARDATION


class Backlash(Compliance):
    """torque on the link = stiffness * (r - q beyond +-gap/2), r the motor's angle (logged), q the link's.

    It is zero inside the gap. While a flank touches, it is damped by stiffness * t (r' - q'); t is the
    model's `flank_retardation_s`.
    """

    name = "backlash"
    parameters = Parameters(
        Parameter(
            "gap",
            "rad",
            about="all the play, from one flank to the other",
            within=lambda model, place: (0.0, 1.0),
            least=1e-5,
            blur=lambda values, position, torque: values["gap"] / 12.0,
            example=0.03,
            linear=False,
        ),
        Parameter(
            "stiffness",
            "N*m/rad",
            lower=1e-3,
            about="of either flank",
            within=lambda model, place: (1e-3, stiffest(model, place)),
            least=1e-3,
            blur=lambda values, position, torque: values["stiffness"] / 18.0,
            example=200.0,
            linear=False,
        ),
        settles=(FLANK_RETARDATION,),
    )
    locations = ("actuator", "joint")
    words = Words(
        source="Nordin and Gutman, Controlling mechanical systems with backlash, Automatica 38(10), 2002",
        shows="torque residual in bursts where the transmitted torque changes sign; small limit cycles",
        reveal="slow reversals with little load on the axis, and a sweep of small amplitude",
        mujoco="native: a joint for the motor, and a tendon to the links whose spring has a dead band; "
        "damping of flanks is a torque function",
        needs="inertia on both sides: of the drive in [actuators] or as armature, and of the link; once",
    )
    search = Search(contains=("joint_compliance",), frf_signature=FrfSignature.ODD)
    diverges = True

    def initial_values(
        self, motions: Sequence[Motion], model: Model, place: Place
    ) -> Sequence[tuple[Values, float]]:
        """The gap that foresees best what passes through it: a grid, then downhill from its best."""
        inertia, _ = link_inertia(motions[0], model, place)
        if inertia <= 0.0:  # a rotor as heavy as all that turns leaves nothing behind it
            return []
        rotor = float(motions[0].rotor[0][place.index])
        way = max(float(np.ptp(m.position[:, place.index])) for m in motions) + 1e-9
        pieces = [Passage.of(m, model, place) for m in motions]
        stiffnesses = inertia * frequencies(motions, 10.0, 100.0, 9) ** 2
        top = stiffest(model, place)
        gaps = way * np.geomspace(2e-4, 0.1, 9)
        gap, stiffness, retardation, least = best_gap(pieces, inertia, rotor, gaps, stiffnesses, top)
        if gap < 1e-4 * way:
            return []  # a spring, which is another effect
        rigid = left_by(pieces, inertia, 0.0, top, 0.0)
        shape = {"gap": gap, "stiffness": stiffness, "retardation": retardation}
        if not foresees(pieces, inertia, gap, stiffness, retardation):
            return []
        return [(shape, least / max(rigid, 1e-300))]

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """No free coefficient: what the links do not feel of the motor's motion while they cross the gap."""
        inertia, column = link_inertia(motion, model, place)
        passage = Passage.of(motion, model, place)
        retardation = shape.get("retardation", model.flank_retardation_s)
        error = passage.unforeseen(inertia, shape["gap"], shape["stiffness"], retardation)
        # foreseen is what passed less the error; what rigid links would take beyond that, the motor need not
        share = (passage.load - passage.passed + error) / inertia
        return Response(np.zeros((0, *motion.position.shape)), offset=share[:, None] * column)

    def foretells(self, motions: Sequence[Motion], model: Model, place: Place, shape: Values) -> bool:
        """Where the torque does not lead it by the hand."""
        inertia, _ = link_inertia(motions[0], model, place)
        retardation = shape.get("retardation", model.flank_retardation_s)
        pieces = [Passage.of(m, model, place) for m in motions]
        return foresees(pieces, inertia, shape["gap"], shape["stiffness"], retardation)

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """A joint for the motor and a tendon with a dead band to the links."""
        stiffness = values["stiffness"]
        split(build, model, place, stiffness, model.flank_retardation_s * stiffness, values["gap"])
