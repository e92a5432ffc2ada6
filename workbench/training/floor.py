"""The floor under a quadruped: that of the task, with what was identified of the ground of one leg."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from workbench.core import InputError
from workbench.effects.chain import Build, TorqueChain
from workbench.effects.ground import contact_rates, lay_ground, settle_contacts
from workbench.models import Ground, Model

from .contact import ContactLaw

_LAW, _FRICTION = "contact_compliance", "ground_friction"
_TURN = 1.0  # rad a step that a foot may swing on its contact; beyond, a step is too long for it


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
    _lay(spec, model, Ground(tuple(feet), surface="ground", friction=law.friction, **sunk))
    return spec.compile()


def lay_floor(spec: mujoco.MjSpec, model: Model, feet: Sequence[str], surface: str) -> tuple[str, ...]:
    """Give contacts of feet and floor the identified friction and contact law of the leg, if there are
    any.

    All else is the task's: what a model states of its ground is what that one leg stood on.

    Args:
        spec: of the whole machine; its time step is set.
        model: of one leg.
        feet: geoms.
        surface: geom of the floor.

    Returns:
        What was found and this floor cannot have: contacts that are too stiff for the time step.
    """
    found = {e.key.effect: e.values for e in model.effects}
    friction = found.get(_FRICTION, {}).get("coefficient")
    ground = Ground(tuple(feet), surface=surface, friction=friction, **found.get(_LAW, {}))
    if ground.stiffness is not None and not _slow_enough(spec, model, ground):
        ground = replace(ground, stiffness=None, damping=None)
        left_out = (_LAW,)
    else:
        left_out = ()
    if ground.friction is not None or ground.stiffness is not None:
        _lay(spec, model, ground)
    return left_out


def _lay(spec: mujoco.MjSpec, model: Model, ground: Ground) -> None:
    build = Build(spec, spec, TorqueChain.of(model), {})
    lay_ground(build, ground)
    settle_contacts(build)


def _slow_enough(spec: mujoco.MjSpec, model: Model, ground: Ground) -> bool:
    tried = spec.copy()
    _lay(tried, model, ground)
    spring, damper = contact_rates(tried.compile())
    fastest = np.abs(np.roots([1.0, 2.0 * damper, 2.0 * spring])).max()
    return bool(fastest * spec.option.timestep < _TURN)
