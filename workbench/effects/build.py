"""From a model to what MuJoCo runs: the serial tree with every effect of the model installed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.core import SimulationError
from workbench.models import Model, Placement, axis_tendon, base_spec, joint_kinds

from .catalogue import effect_named
from .chain import Build, TorqueChain
from .friction_constraint import set_friction_constraints


@dataclass(frozen=True)
class Plant:
    """A compiled model: MuJoCo's, and the torque chain in front of it.

    `drives` (n, nv): speeds of MuJoCo's joints to those of the drives; its transpose takes torque back.
    """

    model: Model
    mujoco: mujoco.MjModel
    chain: TorqueChain
    drives: np.ndarray

    def state_at(self, start: np.ndarray) -> np.ndarray:
        """Position and rate of MuJoCo's joints (2, nv) from those of the serial joints, (2, n)."""
        out = np.stack([self.mujoco.qpos0, np.zeros(self.mujoco.nv)])
        out[:, [self.mujoco.joint(name).dofadr[0] for name in self.model.joints]] = start
        return out


def build(model: Model, timestep: float = 0.001, held: Sequence[str] = ()) -> Build:
    """Install every effect of a model into its spec and torque chain.

    Args:
        model: the model.
        timestep: integration step [s].
        held: joints that the rig holds still.
    """
    out = Build(base_spec(model, timestep, held), TorqueChain.of(model))
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
    drives = np.stack([tendon_row(compiled, axis_tendon(i)) for i in range(model.size)])
    return Plant(model, compiled, made.chain, drives)


def tendon_row(m: mujoco.MjModel, name: str) -> np.ndarray:
    """Coefficients (nv,) of a fixed tendon: its speed is their product with the joints' speeds."""
    ident, row = m.tendon(name).id, np.zeros(m.nv)
    for k in range(m.tendon_adr[ident], m.tendon_adr[ident] + m.tendon_num[ident]):
        row[m.jnt_dofadr[m.wrap_objid[k]]] += m.wrap_prm[k]
    return row
