"""Gravity of the links that the serial tree leaves out."""

from __future__ import annotations

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model

from .base import WHOLE, FrfSignature, Search, Words
from .chain import Build
from .motion import Motion
from .parameter import INF, Parameter, Parameters, Place, Values
from .structural import Structural
from .structure import crank_of, gravity_columns, is_parallelogram
from .weights import add_gravity


class LinkageGravity(Structural):
    """torque_i = -g_i sin(q_i), added to the gravity of the serial tree."""

    name = "linkage_gravity"
    parameters = Parameters(
        Parameter("g1", "N*m", lower=-INF, example=0.163091),
        Parameter("g2", "N*m", lower=-INF, example=0.132743),
    )
    locations = WHOLE
    words = Words(
        source="potential energy of the parallelogram; the paper leaves it out (after Eq. 21)",
        shows="torque residual follows a sine of each drive's angle, at every speed",
        reveal="a slow sweep over the widest range of both drives",
        mujoco="native: bodies on the links that have weight and next to no mass (fixed base)",
        needs="a parallelogram: two drives that turn two joints by ((1, 0), (1, 1))",
    )
    search = Search(depends_on=("position",), frf_signature=FrfSignature.EVEN, basic=True)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """On a parallelogram."""
        return is_parallelogram(model)

    def columns(self, motion: Motion) -> np.ndarray:
        """Return the torque of 1 N m each."""
        return gravity_columns(motion)

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Bodies that have weight and next to no mass."""
        add_gravity(build.spec, model, values["g1"], values["g2"], crank_of(model))
