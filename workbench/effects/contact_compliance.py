"""A ground that gives way under a foot."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import nnls

from workbench.models import Model

from .base import WHOLE, Words
from .chain import Build
from .contact import NEEDS, OnGround
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values

_TOUCHES = 6.0  # of the force's noise: a foot that is pressed harder touches
_FEWEST = 20  # rows
_SOFTEST, _STIFFEST = 1e2, 1e7  # N/m: foam, and what no log of positions resolves


class ContactCompliance(OnGround):
    """normal force = stiffness * d + damping * d', never negative, d the depth of the foot in the ground."""

    name = "contact_compliance"
    parameters = Parameters(
        Parameter(
            "stiffness", "N/m", lower=_SOFTEST, upper=_STIFFEST, least=1.0, example=30000.0, linear=False
        ),
        Parameter(
            "damping",
            "N*s/m",
            upper=1e5,
            least=lambda shape: 1e-3 * shape["stiffness"] ** 0.5,
            example=100.0,
            linear=False,
        ),
    )
    locations = WHOLE
    words = Words(
        source="Kelvin-Voigt contact; K. L. Johnson, Contact Mechanics, 1985, Ch. 6 and 11",
        shows="normal force that grows with the foot's depth, where the model has hard ground",
        reveal="pressing slowly to several forces (stiffness), then stepping and bouncing on it (damping)",
        mujoco="native: solref (-s, -b) and solimp of the contact pair, elliptic cone; exact but for "
        "a thousandth "
        "of the foot's mass, which moves with what it touches",
        needs=NEEDS,
    )

    def initial_values(self, motions: Sequence[Motion]) -> Sequence[Values]:
        """Least squares of the measured force on depth and its rate, over the rows in which a foot touches.

        Where that has no damping, one that takes a tenth of a bounce.
        """
        depth, rate, force = [], [], []
        for contact in (m.contact for m in motions):
            if contact is not None:
                rows = (contact.pressed > _TOUCHES * contact.force_noise) & (contact.depth > 0.0)
                depth.append(contact.depth[rows])
                rate.append(contact.sinking[rows])
                force.append(contact.pressed[rows])
        if sum(map(len, force)) < _FEWEST:
            return ()
        x, y = np.stack([np.concatenate(depth), np.concatenate(rate)], axis=1), np.concatenate(force)
        (stiffness, damping), _ = nnls(x, y)
        stiffness = float(np.clip(stiffness, _SOFTEST, _STIFFEST))
        return ({"stiffness": stiffness, "damping": max(float(damping), 1e-3 * stiffness**0.5)},)

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """The law of the contacts, settled once all masses are there."""
        build.contact_law = values["stiffness"], values["damping"]
