"""The floor under a quadruped: that of the task, with what was identified of the ground of one leg."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np

from workbench.effects.chain import Build, TorqueChain
from workbench.effects.ground import contact_rates, lay_ground, settle_contacts
from workbench.models import Ground, Model

_LAW, _FRICTION = "contact_compliance", "ground_friction"
_TURN = 1.0  # rad a step that a foot may swing on its contact; beyond, a step is too long for it


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
