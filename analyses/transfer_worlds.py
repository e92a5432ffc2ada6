"""Simulations of the transfer study: with an identified ground, a payload, and pushes on the trunk."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.core import InputError
from workbench.effects.chain import Build, TorqueChain
from workbench.effects.ground import lay_ground, settle_contacts
from workbench.models import Ground, Model
from workbench.training.machine import LEGS, STEP_S, STIFF_S, Machine

_LAW, _FRICTION = "contact_compliance", "ground_friction"


@dataclass(frozen=True)
class Push:
    """Pushes on the trunk from the side, to the left and to the right in turn.

    Attributes:
        force: at the trunk's origin, along its own y [N].
        lasts_s: of each [s].
        first_s, every_s: when the first begins after the hold, and from one to the next [s].
    """

    force: float = 100.0
    lasts_s: float = 0.1
    first_s: float = 1.5
    every_s: float = 1.13

    def at(self, time: float, base: np.ndarray) -> np.ndarray:
        """Return the force in the world (3,) [N] at a time after the hold, for a pose of the trunk (7,)."""
        since = time - self.first_s
        if since < 0.0 or since % self.every_s >= self.lasts_s - 1e-9:
            return np.zeros(3)
        w, x, y, z = base[3:]
        side = np.array([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 0.0])
        sign = 1.0 if int(since // self.every_s) % 2 == 0 else -1.0
        return sign * self.force * side / np.linalg.norm(side)


@dataclass(frozen=True)
class ContactLaw:
    """A contact law: a spring and damper of acceleration, critically damped, as MuJoCo's ``solref``.

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


#: As `train` has it, MuJoCo's own; as with `--stiff-contact`; and in short steps with a round cone, which
#: resolve it.
TRAINED = ContactLaw(0.02, STEP_S, elliptic=False)
TRAINING = ContactLaw(STIFF_S, STEP_S, elliptic=False)
EVALUATION = ContactLaw(STIFF_S, 0.0005, elliptic=True)


@dataclass(frozen=True)
class IdentifiedLaw:
    """A contact law as `contact_compliance` and `ground_friction` have it, for steps that resolve it.

    Attributes:
        stiffness: of a contact [N/m].
        damping: of a contact [N s/m].
        friction: coefficient of the ground.
        step_s: of the simulation [s].
    """

    stiffness: float
    damping: float
    friction: float
    step_s: float = 0.0005

    def __str__(self) -> str:
        return (
            f"{1e-3 * self.stiffness:.3g} kN/m, {self.damping:.3g} N s/m, friction {self.friction:.2f}, "
            f"steps of {1e3 * self.step_s:g} ms"
        )

    @staticmethod
    def of(model: Model) -> IdentifiedLaw:
        """Return the law that was identified as effects of a model.

        Raises:
            InputError: the model lacks one of the two effects.
        """
        found = {e.key.effect: e.values for e in model.effects}
        missing = [name for name in (_LAW, _FRICTION) if name not in found]
        if missing:
            raise InputError(
                f"no {' and no '.join(missing)} was identified", file=model.source,
                remedy="improve a model of the leg with recordings on a force plate",
            )  # fmt: skip
        return IdentifiedLaw(**found[_LAW], friction=found[_FRICTION]["coefficient"])


#: Either a time constant, or stiffness and damping.
Law = ContactLaw | IdentifiedLaw


def laid(law: Law, xml: str, m: mujoco.MjModel, model: Model, feet: Sequence[str]) -> mujoco.MjModel:
    """Return a compiled machine with a law under its feet.

    Args:
        law: of its contacts and steps.
        xml: of the whole machine, with a geom ``ground``.
        m: the same, compiled; it stays as it is.
        model: of one leg.
        feet: geoms.
    """
    if isinstance(law, ContactLaw):
        return law.applied(m, feet)
    spec = mujoco.MjSpec.from_string(xml)
    spec.option.timestep = law.step_s
    sunk = {"stiffness": law.stiffness, "damping": law.damping}
    build = Build(spec, spec, TorqueChain.of(model), {})
    lay_ground(build, Ground(tuple(feet), surface="ground", friction=law.friction, **sunk))
    settle_contacts(build)
    return spec.compile()


def world_of(machine: Machine, law: Law, payload: float) -> mujoco.MjModel:
    """Return the simulation of a quadruped with a law under its feet and a payload [kg] on its trunk."""
    m = laid(law, machine.xml, machine.mujoco, machine.model, [f"{leg}_sphere" for leg in LEGS])
    return loaded(m, payload) if payload else m


def loaded(m: mujoco.MjModel, mass: float) -> mujoco.MjModel:
    """Return a copy of a compiled machine with a point mass [kg] at the origin of its trunk."""
    made = m.__copy__()
    body = int(m.jnt_bodyid[0])
    own, at, turn = m.body_mass[body], m.body_ipos[body], np.zeros(9)
    mujoco.mju_quat2Mat(turn, m.body_iquat[body])
    turn = turn.reshape(3, 3)
    inertia = turn @ np.diag(m.body_inertia[body]) @ turn.T
    share = own * mass / (own + mass)  # of two masses about their common centre
    inertia += share * (at @ at * np.eye(3) - np.outer(at, at))
    size, axes = np.linalg.eigh(inertia)
    axes[:, 0] *= np.linalg.det(axes)
    made.body_mass[body], made.body_ipos[body] = own + mass, at * own / (own + mass)
    made.body_inertia[body] = size
    mujoco.mju_mat2Quat(made.body_iquat[body], axes.ravel())
    mujoco.mj_setConst(made, mujoco.MjData(made))
    return made
