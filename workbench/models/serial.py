"""The serial tree as MuJoCo simulates it, before any effect: one spec, with one tendon per axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import mujoco
import numpy as np

from workbench.core import EffectKey

from .model import Model
from .shared_drives import tendon_row
from .spec import load_tree
from .urdf import is_urdf


@dataclass(frozen=True)
class Placement:
    """The place of an effect: a row of coefficients over the serial joints, and its actuator coordinates.

    `row` (n,): the axis coordinate is ``row @ q_s``. `index`: the axis number. `location` as in
    `EffectKey`. For a drive `row` is a row of the transmission; for a pin it is a unit vector.
    """

    index: int
    location: str
    row: np.ndarray

    @staticmethod
    def of(model: Model, key: EffectKey) -> Placement | None:
        """Return the placement of an effect on one axis; None if it acts on all axes."""
        if key.axis is None:
            return None
        index = model.axes.index(key.axis)
        row = model.transmission[index] if key.location == "actuator" else np.eye(model.size)[index]
        return Placement(index, key.location, row)

    @property
    def tendon(self) -> str:
        """Return the name of the fixed tendon whose length is this coordinate."""
        return axis_tendon(self.index, self.location)


def axis_tendon(index: int, location: str = "actuator") -> str:
    """Return the name of the tendon that carries an axis's own damping, friction, spring and inertia."""
    return f"{location}:{index}"


def base_spec(model: Model, timestep: float = 0.001, held: Sequence[str] = ()) -> mujoco.MjSpec:
    """Return the serial tree with Kin-Only actuators, ready for effects to be installed.

    Every axis, at the drive and at the pin, is a fixed tendon, so that a drive which moves two joints
    (row (1, 1) of the parallelogram) carries inertia, damping and friction without code per step.
    The MJCF's own actuators are left out: a recording says which torque acted.

    Args:
        model: the model; its `effects` are not installed here.
        timestep: integration step [s].
        held: joints that a rig holds still; they are removed.
    """
    spec = load_tree(model.serial)
    for kind in (spec.keys, spec.sensors, spec.actuators):
        for element in list(kind):
            spec.delete(element)
    for name in held:
        spec.delete(spec.joint(name))
    spec.option.timestep = timestep
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.iterations, spec.option.tolerance = 50, 1e-12
    # a run that diverges shall be seen to, not started afresh
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    for i, name in enumerate(model.joints):
        if name in held:
            continue
        joint = spec.joint(name)
        joint.armature = joint.armature + model.actuators.inertia[i]
        joint.damping[0] += model.actuators.damping[i]
    for location, matrix in (("actuator", model.transmission), ("joint", np.eye(model.size))):
        for index, row in enumerate(matrix):
            tendon = spec.add_tendon(name=axis_tendon(index, location))
            for name, coefficient in zip(model.joints, row, strict=True):
                if coefficient and name not in held:
                    tendon.wrap_joint(name, float(coefficient))
    for seat in drive_tendons(model):
        own, drive = spec.tendons[seat.tendon], spec.tendon(axis_tendon(seat.index))
        drive.armature += own.armature * seat.ratio**2
        drive.damping[0] += own.damping[0] * seat.ratio**2
        own.armature = own.damping[0] = 0.0
    return spec


@dataclass(frozen=True)
class DriveTendon:
    """A fixed tendon of an MJCF with a length proportional to a drive's angle: it represents the drive.

    How S3N writes a drive that turns several joints (paper, Eq. 7): the tendon's armature is its rotor.
    `tendon`: its number in the file; `name`: empty where it has none.
    """

    tendon: int
    name: str
    index: int
    ratio: float


def drive_tendons(model: Model) -> tuple[DriveTendon, ...]:
    """The tendons of a file that represent its drives; a drive alone on a joint has its numbers there."""
    m, alone, out = _compiled(model.serial), drives_alone(model)[0], list[DriveTendon]()
    for k in range(m.ntendon):
        turned = tendon_row(m, k)
        row = np.array([turned.get(name, 0.0) for name in model.joints])
        for index, drive in enumerate(model.transmission):
            ratio = float(row @ drive / (drive @ drive))
            if not alone[index] and ratio and np.allclose(row, ratio * drive, rtol=1e-9, atol=0.0):
                out.append(DriveTendon(k, m.tendon(k).name, index, ratio))
    return tuple(out)


def rotors(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Return inertia and damping (n,) of each drive itself [kg m^2 or kg; N m s/rad or N s/m].

    What the model file states, and what the MJCF has at a joint that one drive turns, and no other, or at a
    tendon that is the drive: there its armature is that drive's rotor, and its damping the drive's.
    """
    m = _compiled(model.serial)
    dofs = [m.joint(name).dofadr[0] for name in model.joints]
    alone, joint, ratio = drives_alone(model)
    own = np.where(alone, 1.0 / np.where(alone, ratio, 1.0) ** 2, 0.0)
    inertia = np.array(model.actuators.inertia) + own * m.dof_armature[dofs][joint]
    damping = np.array(model.actuators.damping) + own * m.dof_damping[dofs][joint]
    for seat in drive_tendons(model):
        inertia[seat.index] += float(m.tendon_armature[seat.tendon]) * seat.ratio**2
        damping[seat.index] += float(m.tendon_damping[seat.tendon]) * seat.ratio**2
    return inertia, damping


def springs(model: Model) -> np.ndarray:
    """Return the stiffness (n,) of each drive itself [N m/rad or N/m], from the MJCF as for `rotors`."""
    m = _compiled(model.serial)
    alone, joint, ratio = drives_alone(model)
    own = np.where(alone, 1.0 / np.where(alone, ratio, 1.0) ** 2, 0.0)
    stiffness = own * np.array([float(m.jnt_stiffness[m.joint(name).id]) for name in model.joints])[joint]
    for seat in drive_tendons(model):
        stiffness[seat.index] += float(m.tendon_stiffness[seat.tendon]) * seat.ratio**2
    return stiffness


def drives_alone(model: Model) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which drives turn one joint that no other turns, the first joint of each, and its ratio: (n,) each."""
    turns = model.transmission != 0.0
    alone = (turns.sum(axis=1) == 1) & (turns[:, turns.argmax(axis=1)].sum(axis=0) == 1)
    return alone, turns.argmax(axis=1), model.transmission.sum(axis=1)


def turned_joint(model: Model, place: Placement) -> tuple[str, float] | None:
    """Return the joint whose own numbers belong to a place, and the place's coordinate over the joint's.

    The joint of a pin; of a drive the one that it turns, and no other: None where there is no such joint.
    """
    if place.location == "joint":
        return model.joints[place.index], 1.0
    alone, joint, ratio = drives_alone(model)
    return (model.joints[joint[place.index]], float(ratio[place.index])) if alone[place.index] else None


def _compiled(serial: Path) -> mujoco.MjModel:
    """Return a tree as its file states it; read only."""
    return _compiled_once(serial, serial.stat().st_mtime_ns)


@lru_cache(maxsize=64)
def _compiled_once(serial: Path, written: int) -> mujoco.MjModel:
    del written  # a file that was written anew is another tree
    return load_tree(serial).compile()


def joint_kinds(model: Model) -> tuple[str, ...]:
    """Return ``hinge`` or ``slide`` per serial joint."""
    return _kinds(model.serial, tuple(model.joints))


@lru_cache(maxsize=64)
def _kinds(serial: Path, joints: tuple[str, ...]) -> tuple[str, ...]:
    spec = load_tree(serial)
    slide = mujoco.mjtJoint.mjJNT_SLIDE
    return tuple("slide" if spec.joint(name).type == slide else "hinge" for name in joints)


def limits_left_out(model: Model) -> str | None:
    """A note on torque limits of the MJCF's actuators, which simulations here ignore; None without any."""
    if np.isfinite(model.actuators.torque_limit).any():
        return None
    names = [name for name in model.joints if name in _limited(model.serial)]
    if not names:
        return None
    whose = (
        f"efforts that the URDF states for {', '.join(names)} are left out"
        if is_urdf(model.serial)
        else f"limits of the MJCF's actuators on {', '.join(names)} are left out, as all its actuators are"
    )
    return f"{whose}; to use them, state torque_limit under [actuators] in a model TOML"


def free_joints(model: Model) -> str | None:
    """Return a note on joints of the file that are no axis and held by nothing; None without any."""
    m = _compiled(model.serial)
    names = [m.joint(k).name for k in range(m.njnt) if m.joint(k).name not in model.joints]
    if not names:
        return None
    what = 'type="fixed"' if is_urdf(model.serial) else "take its <joint> out"
    return (
        f"{', '.join(names)} of {model.serial.name} is not an axis of the model: nothing drives it, so it "
        f"moves freely here. If the machine holds it, fix it in a copy of the file ({what})"
    )


@lru_cache(maxsize=64)
def _limited(serial: Path) -> frozenset[str]:
    """Return joints whose torque the MJCF limits, by an actuator's force or control range, or their own."""
    m = load_tree(serial).compile()
    on_joint = m.actuator_trntype == int(mujoco.mjtTrn.mjTRN_JOINT)
    motor = m.actuator_biastype == int(mujoco.mjtBias.mjBIAS_NONE)  # else its control is no torque
    limited = on_joint & ((m.actuator_forcelimited > 0) | (motor & (m.actuator_ctrllimited > 0)))
    joints = {*m.actuator_trnid[limited, 0].tolist(), *np.flatnonzero(m.jnt_actfrclimited > 0).tolist()}
    return frozenset(m.joint(k).name for k in joints)
