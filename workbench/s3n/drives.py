"""Drives in a normalised tree: on a joint where they move one, on a tendon where several; a motor each."""

from __future__ import annotations

import mujoco
import numpy as np

from workbench.effects import BASE_JOINT, Build, Plant
from workbench.models import Model, axis_tendon

#: Stages of the torque chain that a motor of plain MJCF has.
MOTOR_STAGES = ("delay_s", "limit", "gain", "bias")
_LINEAR = mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_TENDON


def settle_axes(made: Build, plant: Plant) -> list[str]:
    """Take every axis that moves one joint from its tendon to that joint, which costs less a step.

    Args:
        made: a built tree, changed in place: the tendon of a drive that moves several joints gets the axis's
            name, the others go.
        plant: the same, compiled.

    Returns:
        name of the tendon that moves with each drive, in the order of the axes; empty for a joint.
    """
    model, spec, names = plant.model, made.spec, []
    _dry(spec, plant.mujoco)
    for index, axis in enumerate(model.axes):
        name = axis if all(t.name != axis for t in spec.tendons) else f"{axis}_drive"
        tendon = axis_tendon(index)
        if len(made.rows[tendon]) == 1:
            _to_joint(made, plant, tendon, name)
            names.append("")
        else:
            spec.tendon(tendon).name = name
            names.append(name)
        _to_joint(made, plant, axis_tendon(index, "joint"), f"{axis}_pin")
    if BASE_JOINT in made.rows:
        _to_joint(made, plant, BASE_JOINT, BASE_JOINT)
    return names


def _to_joint(made: Build, plant: Plant, axis: str, name: str) -> None:
    """Move inertia, damping, spring and dry friction of a tendon to its only joint, and delete it."""
    spec, tendon = made.spec, made.spec.tendon(axis)
    ((moved, coefficient),) = made.rows[axis].items()
    joint = spec.joint(moved)
    if tendon.frictionloss and joint.frictionloss:
        # two frictions side by side set in each its own way
        tendon.name = name
        return
    joint.armature += coefficient**2 * tendon.armature
    joint.damping = np.asarray(joint.damping) + coefficient**2 * np.asarray(tendon.damping)
    if tendon.frictionloss:
        joint.solref_friction, joint.solimp_friction = tendon.solref_friction, tendon.solimp_friction
        joint.frictionloss = abs(coefficient) * tendon.frictionloss
    stiffness = coefficient**2 * float(tendon.stiffness[0])
    if stiffness:
        before, rest = float(joint.stiffness[0]), float(tendon.springlength[0]) / coefficient
        joint.springref = (before * joint.springref + stiffness * rest) / (before + stiffness)
        joint.stiffness[0] = before + stiffness
    spec.delete(tendon)


def _dry(spec: mujoco.MjSpec, m: mujoco.MjModel) -> None:
    """Make all dry friction set in as it does in the compiled plant, also that of the user's file."""
    for tendon in spec.tendons:
        if tendon.frictionloss:
            k = m.tendon(tendon.name).id
            tendon.solref_friction, tendon.solimp_friction = m.tendon_solref_fri[k], m.tendon_solimp_fri[k]
    for joint in spec.joints:
        if joint.frictionloss:
            k = m.joint(joint.name).dofadr[0]
            joint.solref_friction, joint.solimp_friction = m.dof_solref[k], m.dof_solimp[k]


def add_motors(made: Build, model: Model, tendons: list[str]) -> None:
    """Add one motor per drive, commanded by its torque; J^T is in the motor's transmission (paper, Eq. 4)."""
    spec, chain, step = made.spec, made.chain, made.spec.option.timestep
    for index, (axis, tendon) in enumerate(zip(model.axes, tendons, strict=True)):
        joint, coefficient = next(iter(made.rows[axis_tendon(index)].items()))
        motor = spec.add_actuator(name=axis)
        motor.set_to_motor()
        motor.trntype = _LINEAR[bool(tendon)]
        motor.target = tendon or joint
        motor.gear = np.zeros(6)
        motor.gear[0] = 1.0 if tendon else coefficient
        gain, bias, limit = (float(x[index]) for x in (chain.gain, chain.bias, chain.limit))
        motor.gainprm[0] = gain
        if bias:
            motor.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            motor.biasprm[:3] = bias, 0.0, 0.0
        motor.ctrllimited, motor.forcelimited = int(np.isfinite(limit)), 0
        if np.isfinite(limit):
            motor.ctrlrange = -limit, limit
            if gain == 1.0 and not bias:  # gain and bias act behind the limit
                motor.forcelimited, motor.forcerange = 1, (-limit, limit)
        if chain.delay_s:
            whole = abs(chain.delay_s / step - round(chain.delay_s / step)) < 1e-9
            motor.delay, motor.interp = chain.delay_s, 0 if whole else 1
            # MuJoCo shortens a delay that its buffer cannot hold: room for steps of half the length
            motor.nsample = 2 * int(np.ceil(chain.delay_s / step - 1e-9)) + 1
