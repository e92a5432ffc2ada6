"""From a model to what MuJoCo runs: the serial tree with every effect of the model installed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from workbench.core import SimulationError
from workbench.models import AppliedEffect, Model, Placement, axis_tendon, load_tree, take_friction
from workbench.models.engine import warned

from .catalogue import effect_named
from .chain import Build, TorqueChain
from .compliance import Compliance
from .flexible import rotor_name
from .friction_constraint import set_friction_constraints
from .ground import add_force_plate, lay_ground, lift_off, settle_contacts
from .kinds import is_additive
from .stiffness import count_substeps, tendon_row

_LEAST = 1e-12  # kg m^2 or kg: a grain of dust at a hair's breadth


@dataclass(frozen=True)
class Plant:
    """A compiled model: MuJoCo's, and the torque chain in front of it.

    `drives` (n, nv): speeds of MuJoCo's joints to those of the drives; its transpose takes torque back.
    `lift` (nv, n): serial coordinates to MuJoCo's joints as long as nothing bends. `substeps`: steps of
    MuJoCo's in one of the simulation, more than one where springs are stiff. `contacts`: names of the
    contact sensors of feet on the ground, none for a machine that is off it. `links`: MuJoCo's model that has
    the links; `bare`: that before any effect, where it is another one, since drives carry them.
    """

    model: Model
    mujoco: mujoco.MjModel
    chain: TorqueChain
    drives: np.ndarray
    lift: np.ndarray
    links: mujoco.MjModel
    bare: mujoco.MjModel | None = None
    substeps: int = 1
    contacts: tuple[str, ...] = ()

    def state_at(self, serial: np.ndarray) -> np.ndarray:
        """Return position and rate of MuJoCo's joints (..., 2, nv) from those of the serial joints,
        (..., 2, n).
        """
        apart = np.where(self.lift.any(axis=1), 0.0, self.mujoco.qpos0)
        return serial @ self.lift.T + np.stack([apart, np.zeros_like(apart)])


def build(model: Model, timestep: float = 0.001, held: Sequence[str] = (), grounded: bool = True) -> Build:
    """Install every effect of a model into its spec and torque chain, and the dry friction of its file.

    Args:
        model: the model.
        timestep: integration step [s].
        held: joints that the rig holds still.
        grounded: whether it stands on its ground, where it states one; its contacts are to be settled
            once no mass changes any more.
    """
    out = Build.of(model, timestep, held)
    if model.ground is not None:
        if grounded:
            lay_ground(out, model.ground)
        else:
            lift_off(out.spec, model.ground)
    for applied in sorted(_added_up((*take_friction(out.spec, model), *model.effects)), key=_turn):
        effect = effect_named(applied.key.effect)
        effect.install(out, model, Placement.of(model, applied.key), applied.values)
    return out


def _added_up(effects: Sequence[AppliedEffect]) -> list[AppliedEffect]:
    """Effects, what a model states of one and what was found to be more or less of it as one."""
    out: list[AppliedEffect] = []
    for applied in effects:
        first = next((k for k, a in enumerate(out) if a.key == applied.key), None)
        if first is None or not is_additive(effect_named(applied.key.effect)):
            out.append(applied)
            continue
        total = dict(applied.parameters)  # of what may be left out one may have it, and the other not
        for name, e in out[first].parameters.items():
            total[name] = replace(e, value=e.value + (total[name].value if name in total else 0.0))
        out[first] = replace(out[first], parameters=total)
    return out


def _turn(applied: AppliedEffect) -> tuple[bool, bool, bool, int]:
    """New joints first, the base's ahead of those at pins, these ahead of those at drives; then by stages."""
    effect = effect_named(applied.key.effect)
    if not isinstance(effect, Compliance):
        return True, True, True, effect.stage
    return False, applied.key.axis is not None, applied.key.location == "actuator", 0


def compile_plant(
    model: Model, timestep: float = 0.001, held: Sequence[str] = (), grounded: bool = False
) -> Plant:
    """Return a compiled model for simulation; without ground contact, unless it is `grounded`.

    Raises:
        SimulationError: MuJoCo refuses it (a mass or inertia that no body has); says why.
    """
    made = build(model, timestep, held, grounded)
    add_force_plate(made)
    for term in made.chain.hysteresis:
        # what the spring does the simulation says step by step
        made.spec.tendon(term.spring).springyield = 0.0
    effects = ", ".join(str(e.key) for e in model.effects) or "no effects"
    try:
        with warned() as said:
            settle_contacts(made)
            compiled = made.spec.compile()
            links, bare = (compiled, None) if made.links is made.spec else _carried(made, model)
    except (ValueError, mujoco.FatalError) as error:
        raise SimulationError(f"model '{model.name}' with {effects} cannot be compiled: {error}") from error
    if singular := [line for line in said if "singular" in line]:
        raise SimulationError(
            f"model '{model.name}' with {effects} has a degree of freedom without inertia: {singular[0]}; "
            "give its link a mass, or its drive an inertia"
        )
    _refuse_without_inertia(compiled, model)
    substeps = count_substeps(compiled, made.chain)
    compiled.opt.timestep = timestep / substeps
    for term in made.chain.hysteresis:
        compiled.tendon_stiffness[compiled.tendon(term.spring).id] = 0.0
    set_friction_constraints(compiled, made.chain, model)
    _leave_out_constraints(compiled, made.chain)
    drives = np.stack([tendon_row(compiled, axis_tendon(i)) for i in range(model.size)])
    lift = _lift(compiled, model)
    return Plant(model, compiled, made.chain, drives, lift, links, bare, substeps, tuple(made.contacts))


def _carried(made: Build, model: Model) -> tuple[mujoco.MjModel, mujoco.MjModel]:
    """The tree of links that drives carry, as effects made it and as it was."""
    out = made.links.compile(), load_tree(model.links[0]).compile()
    for m in out:
        # of both only what they differ by is asked for: the links
        m.opt.disableflags |= int(
            mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT
        )
    return out


def _leave_out_constraints(m: mujoco.MjModel, chain: TorqueChain) -> None:
    """Have MuJoCo not look for constraints at every step where there can be none: a fifth of its time."""
    possible = (
        chain.follows_state,  # friction that depends on load or speed is set from step to step
        m.neq > 0,
        m.npair > 0,
        m.jnt_limited.any(),
        m.tendon_limited.any(),
        m.dof_frictionloss.any(),
        m.tendon_frictionloss.any(),
        m.geom_contype.any() and m.geom_conaffinity.any(),
    )
    if not any(possible):
        m.opt.disableflags |= int(
            mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT
        )


def _refuse_without_inertia(m: mujoco.MjModel, model: Model) -> None:
    """Raises SimulationError where a joint moves next to nothing, so that any torque flings it away."""
    data, mass = mujoco.MjData(m), np.zeros((m.nv, m.nv))
    mujoco.mj_forward(m, data)
    mujoco.mj_fullM(m, data, mass)
    inertia = np.diag(mass)
    if m.nv and not inertia.min() > _LEAST:
        joint = m.joint(int(m.dof_jntid[int(np.argmin(inertia))])).name
        raise SimulationError(
            f"model '{model.name}': joint '{joint}' moves an inertia of {inertia.min():.2g}; "
            "give its link a mass, or its drive an inertia"
        )


def _lift(m: mujoco.MjModel, model: Model) -> np.ndarray:
    """Serial coordinates to MuJoCo's joints as long as nothing bends, (nv, n)."""
    lift, names = np.zeros((m.nv, model.size)), {m.joint(i).name for i in range(m.njnt)}
    for i, name in enumerate(model.joints):
        unit, row = np.eye(model.size)[i], model.transmission[i]
        pin, drive = rotor_name(i, "joint"), rotor_name(i, "actuator")
        for joint, coordinate in ((name, unit), (pin, unit), (drive, row)):
            if joint in names:
                lift[m.joint(joint).dofadr[0]] = coordinate
    return lift
