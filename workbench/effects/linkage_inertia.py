"""S3N-Full: the inertia of the linkage that the serial tree leaves out, with its own Coriolis terms."""

from __future__ import annotations

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model

from .base import WHOLE, Search, Words
from .chain import Build
from .motion import Motion
from .parameter import INF, Parameter, Parameters, Place, Values
from .structural import Structural
from .structure import crank_of, inertia_columns, is_parallelogram
from .weights import add_inertia


class LinkageInertia(Structural):
    """Kinetic energy M11 w1^2/2 + M12 cos(alpha) w1 w2 + M22 w2^2/2, added to the serial tree's."""

    name = "linkage_inertia"
    parameters = Parameters(
        Parameter("M11", "kg*m^2", lower=-INF, example=0.00967),
        Parameter("M12", "kg*m^2", lower=-INF, about="factor of cos(alpha)", example=0.002893),
        Parameter("M22", "kg*m^2", lower=-INF, example=0.00516),
    )
    locations = WHOLE
    words = Words(
        source="paper, Eqs. 16 to 20",
        shows="inertia of both drives and a coupling that varies with the cosine of the knee angle",
        reveal="sum- and difference-mode multisines at several knee angles",
        mujoco="native: weightless bodies on the links",
        needs="a parallelogram: two drives that turn two joints by ((1, 0), (1, 1))",
    )
    search = Search(contains=("reflected_inertia",), basic=True)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """On a parallelogram."""
        return is_parallelogram(model)

    def columns(self, motion: Motion) -> np.ndarray:
        """Return minus the torque of 1 kg m^2 each."""
        return inertia_columns(motion)

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Bodies that have inertia and no weight."""
        add_inertia(build.spec, model, values["M11"], values["M12"], values["M22"], crank_of(model))
