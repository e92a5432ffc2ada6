"""Virtual hardware of a model: its own mechanism in Drake, its drives, loop and effects, and what is hidden.

The files are the model's; what moves is not: links come from Drake and not from the serial tree that explains
the recordings, and drives, friction and sensors from `workbench.rigs`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from workbench.core import Controller, InputError, Mechanism
from workbench.core.paths import closed_chain_file
from workbench.core.text import counted
from workbench.models import VARIANTS, Model, load_tree, read_model
from workbench.models.own_friction import own_friction
from workbench.rigs.live_own import LiveOwn
from workbench.rigs.own_machine import HiddenIn, OwnMachine, hide
from workbench.rigs.own_rig import OwnRig
from workbench.rigs.place import Passive
from workbench.rigs.virtual_leg import Sensors

from .opened import opened

_STRUCTURAL = {name for names in VARIANTS.values() for name in names}


def own_rig(
    model: Model, hidden: Sequence[HiddenIn] = (), seed: int = 0, sensors: Sensors | None = None
) -> OwnRig:
    """Virtual hardware that is what the model's files say, and hides what they do not say.

    Args:
        model: with a closed chain, or a tree alone, which is then the machine.
        hidden: effects beyond the model's own.
        seed: of noise.
        sensors: noise and resolution.

    Raises:
        InputError: the base floats, the loop is of a kind that this hardware has not, its mechanism cannot be
            read, or it has an effect that this hardware cannot have.
    """
    if model.floats:
        raise InputError(
            "its base floats, but virtual hardware of your own needs a fixed base", file=model.source,
            remedy="give the model of one limb, its base held",
        )  # fmt: skip
    if model.controller.kind == "cascade_pv":
        raise InputError(
            "its loop is a cascade, and virtual hardware has PD or none", file=model.source,
            column="controller.kind", remedy='give [controller] kind = "pd"',
        )  # fmt: skip
    chain = model.closed_chain
    if chain is not None:
        return _rig(model, chain, None, hidden, seed, sensors)
    with opened(model.serial) as (file, _):
        tree = Mechanism(file, model.joints, model.joints, (), model.payload_site)
        return _rig(model, tree, model.transmission, hidden, seed, sensors)


def own_plants(hidden: Sequence[HiddenIn] = ()) -> Callable[[str, int, float], LiveOwn]:
    """Makes the machines that mechanisms of a CAN configuration are, each of its own model, for `MotorBank`.

    Args:
        hidden: effects in each machine that has their axis.
    """

    def make(name: str, seed: int, row: float) -> LiveOwn:
        model = read_model(name)
        own = [effect for effect in hidden if effect.axis is None or effect.axis in model.axes]
        return LiveOwn(own_rig(model, own, seed), model.actuators.delay_s, row)

    return make


def is_reference_leg(model: Model) -> bool:
    """Return whether a model's mechanism is the reference leg, which has a simulator of its own."""
    chain = model.closed_chain
    return chain is not None and chain.file.resolve() == closed_chain_file("leg").resolve()


def _rig(
    model: Model, mechanism: Mechanism, transmission: np.ndarray | None, hidden: Sequence[HiddenIn],
    seed: int, sensors: Sensors | None,
) -> OwnRig:  # fmt: skip
    drives, loop = model.actuators, model.controller
    machine = OwnMachine(
        model.name, model.axes, mechanism, transmission, list(drives.inertia), list(drives.damping),
        list(drives.torque_limit), drives.delay_s, loop if loop.kind == "pd" else Controller("none"),
    )  # fmt: skip
    _add_joints(model, machine)
    for effect in (*own_friction(model), *model.effects):
        key = effect.key
        if key.effect in _STRUCTURAL:
            continue  # its mechanism has that by itself
        try:
            hide(HiddenIn(key.effect, key.axis, key.location, effect.values), machine)
        except InputError as error:
            raise InputError(
                f"the model's own effect: {error.problem}", file=model.source, column="effects",
                remedy="leave it out of the model that the hardware is made of",
            ) from error  # fmt: skip
    return OwnRig(machine, hidden, seed, sensors)


def _add_joints(model: Model, machine: OwnMachine) -> None:
    """What the serial tree's file says of its joints: rotors, damping and springs there."""
    spec = load_tree(model.serial)
    tree = spec.compile()
    for name, axis in zip(model.joints, machine.axes, strict=True):
        joint = tree.joint(name)
        at = machine.place(axis, "joint")
        machine.joint_inertia[at.index] += float(tree.dof_armature[joint.dofadr[0]])
        damping = float(tree.dof_damping[joint.dofadr[0]])
        stiffness, rest = float(joint.stiffness[0]), float(tree.qpos_spring[joint.qposadr[0]])
        if damping:
            machine.passive.append(Passive(at, lambda q, w, b=damping: -b * w))
        if stiffness:
            machine.passive.append(Passive(at, lambda q, w, k=stiffness, r=rest: -k * (q - r)))


def described(model: Model) -> str:
    """One line that says what the hardware of a model is; nothing of what it hides."""
    loop = model.controller
    tick = f" every {1e3 * loop.period_s:g} ms" if loop.period_s else ""
    held = f"{loop.kind} in {loop.coordinates} coordinates{tick}" if loop.kind == "pd" else "no loop"
    chain = model.closed_chain
    kind = f"the tree of {model.serial.name}" if chain is None else f"the closed chain of {chain.file.name}"
    return (
        f"Virtual hardware of {model.name}: {kind} in Drake, "
        f"{counted(model.size, 'drive')} ({', '.join(model.axes)}), "
        f"{held}, delay {1e3 * model.actuators.delay_s:g} ms."
    )
