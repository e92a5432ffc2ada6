"""A mass at the payload site that the model does not contain."""

from __future__ import annotations

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model

from .base import WHOLE, Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .response import Response


class PayloadMass(Effect):
    """A point mass at the payload site: torque = -m J^T (d(J w)/dt - g), J the site's Jacobian."""

    name = "payload_mass"
    parameters = Parameters(Parameter("mass", "kg", example=0.3))
    stage = SignalStage.MECHANISM
    locations = WHOLE
    words = Words(
        source="Newton-Euler for a point mass; Lynch and Park, Modern Robotics, Ch. 8",
        shows="extra inertia and weight, as from one mass, on every axis that moves the site",
        reveal="a slow sweep over the whole range (weight), then a fast chirp (inertia)",
        mujoco="native: a body of that mass at the site",
        needs="a place: name a site of the MJCF in [payload], or add one at the end",
    )
    search = Search(frf_signature=FrfSignature.EVEN, basic=True)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Return whether the model names a site that carries it."""
        return model.payload_site is not None

    def site(self, model: Model) -> str | None:
        """Return the payload's site."""
        return model.payload_site

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: the torque of a mass of 1 kg."""
        assert model.payload_site is not None
        jacobian = motion.kinematics(model.payload_site)
        drift = np.einsum("kij,kj->ki", np.gradient(jacobian, motion.step, axis=0), motion.velocity)
        acceleration = np.einsum("kij,kj->ki", jacobian, motion.acceleration) + drift
        return Response(-np.einsum("kij,ki->kj", jacobian, acceleration - motion.gravity)[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """A body at the site; no bigger than a point, but with an inertia that MuJoCo accepts."""
        site = build.links.site(model.payload_site)
        mass = values["mass"]
        body = site.parent.add_body(pos=site.pos)
        body.explicitinertial, body.mass, body.ipos = True, mass, np.zeros(3)
        body.inertia = np.full(3, max(1e-9 * mass, 1e-14))
