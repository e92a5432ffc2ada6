"""Friction between a foot and the ground."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.models import Model

from .base import WHOLE, Words
from .chain import Build
from .contact import NEEDS, OnGround
from .ground import set_friction
from .motion import Contact, Motion
from .parameter import Parameter, Parameters, Place, Values

_PRESSED = 10.0  # of the force's noise: below, a ratio of forces says little
_SLIPS = 6.0  # of the slip's noise
_FASTER = 0.005  # m/s: slower may be a foot that rolls or gives way
FEWEST_SLIPS = 20  # rows from which slipping tells the coefficient


class GroundFriction(OnGround):
    """tangential force <= coefficient * normal force, and equal to it while the foot slips."""

    name = "ground_friction"
    parameters = Parameters(Parameter("coefficient", "1", upper=5.0, least=0.01, example=0.35, linear=False))
    locations = WHOLE
    words = Words(
        source="Coulomb 1785; B. Brogliato, Nonsmooth Mechanics, 3rd ed. 2016, Ch. 4",
        shows="tangential force that stays at a fixed share of the normal one while the foot slips",
        reveal="pulling a pressed foot sideways until it slips, at several loads",
        mujoco="native: friction of the contact pair",
        needs=NEEDS,
    )

    def initial_values(self, motions: Sequence[Motion]) -> Sequence[Values]:
        """The middle ratio of forces while a foot slips; none where none ever slipped."""
        ratios = [ratio_in_slip(m.contact) for m in motions if m.contact is not None]
        all_ratios = np.concatenate(ratios) if ratios else np.zeros(0)
        if len(all_ratios) < FEWEST_SLIPS:
            return ()
        return ({"coefficient": float(np.clip(np.median(all_ratios), 1e-3, 5.0))},)

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Friction of the contacts."""
        set_friction(build, values["coefficient"])


def ratio_in_slip(contact: Contact) -> np.ndarray:
    """Return tangential over normal force in the rows (K,) in which a pressed foot slips."""
    pressed = contact.pressed > _PRESSED * contact.force_noise
    slips = contact.slip > max(_SLIPS * contact.slip_noise, _FASTER)
    rows = pressed & slips
    return contact.dragged[rows] / contact.pressed[rows]
