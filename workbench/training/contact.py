"""Contact of feet and floor in MuJoCo, as a stated law.

MuJoCo's contact is a spring and damper of acceleration, critically damped with a time constant (``solref``)
that may not be shorter than twice the step. Its default, 20 ms, lets a foot sink where hardware is hard.
`TRAINING` is the stiffest that training's step allows (``train --stiff-contact``); `EVALUATION`, which judges
a policy, resolves it, with short steps and a round friction cone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco


@dataclass(frozen=True)
class ContactLaw:
    """A contact law.

    Attributes:
        time_constant_s: of the critically damped contact [s].
        step_s: of the simulation [s].
        elliptic: whether the friction cone is round, not a pyramid.
    """

    time_constant_s: float
    step_s: float
    elliptic: bool

    def __str__(self) -> str:
        cone = "elliptic" if self.elliptic else "pyramidal"
        return f"{1e3 * self.time_constant_s:g} ms, steps of {1e3 * self.step_s:g} ms, {cone} cone"

    def applied(self, m: mujoco.MjModel, feet: Sequence[str]) -> mujoco.MjModel:
        """Return a copy of a compiled machine whose feet (spheres with priority over the floor) have
        this law.
        """
        made = m.__copy__()
        made.opt.timestep = self.step_s
        for foot in feet:
            made.geom_solref[made.geom(foot).id] = self.time_constant_s, 1.0
        if self.elliptic:
            made.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        return made


TRAINING = ContactLaw(0.006, 0.003, elliptic=False)
EVALUATION = ContactLaw(0.006, 0.0005, elliptic=True)
