"""A ground that gives way under a foot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.optimize import nnls

from workbench.core import EffectKey
from workbench.models import Model, Placement

from .base import Door, Effect, Parameter
from .chain import Build
from .motion import Motion
from .response import Response

_TOUCHES = 6.0  # of the force's noise: a foot that is pressed harder touches
_FEWEST = 20  # rows
_SOFTEST, _STIFFEST = 1e2, 1e7  # N/m: foam, and what no log of positions resolves


class ContactCompliance(Effect):
    """normal force = k d + c d' while the foot is d deep in the ground, and never pulls."""

    name = "contact_compliance"
    parameters = (
        Parameter("stiffness", "N/m", lower=_SOFTEST, upper=_STIFFEST),
        Parameter("damping", "N*s/m", upper=1e5),
    )
    door = Door.MECHANISM
    axes = "all"
    nonlinear = ("stiffness", "damping")
    by_runs = True
    of_ground = True
    needs = "a [ground] table, and to be there once at most"
    source = "Kelvin-Voigt contact; K. L. Johnson, Contact Mechanics, 1985, Ch. 6 and 11"
    shows = "normal force that grows with how deep the foot goes, where the model has a hard ground"
    reveal = "pressing slowly to several forces (stiffness), then stepping and bouncing on it (damping)"
    mujoco = (
        "native: solref (-s, -b) and solimp of the contact pair, elliptic cone; exact but for a thousandth "
        "of the foot's mass, which moves with what it touches"
    )

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Where the model has a ground, whose law this replaces."""
        return model.ground is not None and not model.has(self.name)

    def guesses(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[tuple[Mapping[str, float], float]]:
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
        (stiffness, damping), rest = nnls(x, y)
        stiffness = float(np.clip(stiffness, _SOFTEST, _STIFFEST))
        values = {"stiffness": stiffness, "damping": max(float(damping), 1e-3 * stiffness**0.5)}
        return ((values, float(rest**2 / np.sum(y**2))),)

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """No torque that a motion alone would tell; simulations do."""
        return Response(np.zeros((0, *motion.position.shape)), offset=np.zeros_like(motion.position))

    def least(self, shape: Mapping[str, float]) -> np.ndarray:
        """A thousandth of critical damping where there is next to none."""
        return np.array([1.0, 1e-3 * shape["stiffness"] ** 0.5])

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """The law of the contacts, settled once all masses are there."""
        build.contact_law = values["stiffness"], values["damping"]
