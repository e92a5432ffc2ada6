"""A Pinocchio model of the tree that MuJoCo compiled.

It is built from the compiled model's fields, not by Pinocchio's own MJCF reader: that reader knows neither
gravity compensation nor the armature of tendons, in which the structural effects of S3N live; and what
MuJoCo's compiler makes of defaults, frames and geoms then holds for both engines.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  (found by way of a .pth file)


@dataclass(frozen=True)
class PinTree:
    """A tree of hinges and slides in Pinocchio.

    Attributes:
        model: with gravity.
        weightless: the same without gravity.
        joints: their names, in Pinocchio's order.
        reference: their MuJoCo positions at which Pinocchio's are zero, (k,).
        compensated: what gravity compensation takes from each joint's weight, (k, 4): mass [kg] and
            first moment [kg m] in the joint's frame.
    """

    model: pin.Model
    weightless: pin.Model
    joints: tuple[str, ...]
    reference: np.ndarray
    compensated: np.ndarray


def build_tree(m: mujoco.MjModel) -> PinTree:
    """Rebuild bodies, joints and sites of a compiled model whose joints are hinges and slides."""
    model = pin.Model()
    model.gravity.linear = m.opt.gravity.copy()
    # a body lies at `placed[b]` in the frame of the Pinocchio joint `carrier[b]`
    carrier, placed = [0], [pin.SE3.Identity()]
    compensated: list[np.ndarray] = []
    for body in range(1, m.nbody):
        parent = int(m.body_parentid[body])
        joint = carrier[parent]
        at = placed[parent] * pin.SE3(_rotation(m.body_quat[body]), m.body_pos[body].copy())
        for j in range(m.body_jntadr[body], m.body_jntadr[body] + m.body_jntnum[body]):
            anchor = pin.SE3(np.eye(3), m.jnt_pos[j].copy())
            joint = model.addJoint(joint, _joint(m, j), at * anchor, m.joint(j).name)
            at = anchor.inverse()
            compensated.append(np.zeros(4))
        carrier.append(joint)
        placed.append(at)
        if joint:
            inertia = _inertia(m, body)
            model.appendBodyToJoint(joint, inertia, at)
            moved = at.act(inertia)
            share = float(m.body_gravcomp[body]) * moved.mass
            compensated[joint - 1] += share * np.array([1.0, *moved.lever])
    for s in range(m.nsite):
        body = int(m.site_bodyid[s])
        place = placed[body] * pin.SE3(_rotation(m.site_quat[s]), m.site_pos[s].copy())
        model.addFrame(pin.Frame(f"site:{m.site(s).name}", carrier[body], place, pin.FrameType.OP_FRAME))
    weightless = pin.Model(model)
    weightless.gravity.linear = np.zeros(3)
    joints = tuple(model.names[1:])
    reference = np.array([m.qpos0[m.joint(name).qposadr[0]] for name in joints])
    return PinTree(model, weightless, joints, reference, np.array(compensated).reshape(-1, 4))


def beside_the_links(m: mujoco.MjModel, joints: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Rotor inertia [kg m^2] and viscous damping [N m s/rad] of joints and fixed tendons, (k, k) each.

    Args:
        m: compiled.
        joints: those of the rows and columns.
    """
    dofs = [int(m.joint(name).dofadr[0]) for name in joints]
    rotors, damping = np.diag(m.dof_armature[dofs]), np.diag(m.dof_damping[dofs])
    for t in range(m.ntendon):
        row = tendon_row(m, t, joints)
        if row is not None:
            rotors += m.tendon_armature[t] * np.outer(row, row)
            damping += m.tendon_damping[t] * np.outer(row, row)
    return rotors, damping


def tendon_row(m: mujoco.MjModel, tendon: int, joints: tuple[str, ...]) -> np.ndarray | None:
    """Coefficients (k,) of a fixed tendon over `joints`; None for a tendon in space."""
    row = np.zeros(len(joints))
    first = int(m.tendon_adr[tendon])
    for w in range(first, first + int(m.tendon_num[tendon])):
        if m.wrap_type[w] != mujoco.mjtWrap.mjWRAP_JOINT:
            return None
        row[joints.index(m.joint(int(m.wrap_objid[w])).name)] += m.wrap_prm[w]
    return row


def _joint(m: mujoco.MjModel, j: int) -> pin.JointModel:
    axis = m.jnt_axis[j].copy()
    if m.jnt_type[j] == mujoco.mjtJoint.mjJNT_SLIDE:
        return pin.JointModelPrismaticUnaligned(axis)
    return pin.JointModelRevoluteUnaligned(axis)


def _inertia(m: mujoco.MjModel, body: int) -> pin.Inertia:
    turn = _rotation(m.body_iquat[body])
    about = turn @ np.diag(m.body_inertia[body]) @ turn.T
    return pin.Inertia(float(m.body_mass[body]), m.body_ipos[body].copy(), about)


def _rotation(quat: np.ndarray) -> np.ndarray:
    """Rotation matrix (3, 3) of a quaternion (w, x, y, z)."""
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, np.array(quat, float))
    return matrix.reshape(3, 3)
