"""From a model to what MuJoCo runs: the serial tree with every effect of the model installed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.core import SimulationError
from workbench.models import Model, Placement, base_spec, joint_kinds

from .catalogue import effect_named
from .chain import Build, TorqueChain
from .friction_constraint import set_friction_constraints


@dataclass(frozen=True)
class Plant:
    """A compiled model: MuJoCo's, and the torque chain in front of it."""

    model: Model
    mujoco: mujoco.MjModel
    chain: TorqueChain


def build(model: Model, timestep: float = 0.001, held: Sequence[str] = ()) -> Build:
    """Install every effect of a model into its spec and torque chain.

    Args:
        model: the model.
        timestep: integration step [s].
        held: joints that the rig holds still.
    """
    chain = TorqueChain(
        delay_s=model.actuators.delay_s,
        limit=np.array(model.actuators.torque_limit),
        gain=np.ones(model.size),
        bias=np.zeros(model.size),
    )
    out = Build(base_spec(model, timestep, held), chain)
    for applied in sorted(model.effects, key=lambda e: effect_named(e.key.effect).door):
        effect = effect_named(applied.key.effect)
        effect.install(out, model, Placement.of(model, applied.key), applied.values)
    return out


def compile_plant(model: Model, timestep: float = 0.001, held: Sequence[str] = ()) -> Plant:
    """Compile a model for simulation.

    Raises:
        SimulationError: MuJoCo refuses it (a mass or inertia that no body has); says why.
    """
    made = build(model, timestep, held)
    try:
        compiled = made.spec.compile()
    except ValueError as error:
        effects = ", ".join(str(e.key) for e in model.effects) or "no effects"
        raise SimulationError(f"model '{model.name}' with {effects} cannot be compiled: {error}") from error
    set_friction_constraints(compiled, made.chain, model, joint_kinds(model))
    return Plant(model, compiled, made.chain)
