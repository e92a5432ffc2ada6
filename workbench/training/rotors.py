"""Drives that move relative to their links: additional joints in the machine, which the encoders read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np


@dataclass(frozen=True)
class Rotors:
    """The k joints on the motor side of springs and gaps; k is 0 if all drives are rigid.

    Attributes:
        places, dofs: where they are in qpos and qvel, (k,) each.
        follow: rotor angles of springs at rest, a row each of the n joints' angles, (k, n).
        drives: what the drives' encoders read, of joints and rotors one after the other, (n, n + k).
    """

    places: np.ndarray
    dofs: np.ndarray
    follow: np.ndarray
    drives: np.ndarray


def no_rotors(joints: int) -> Rotors:
    """Return the rotors of a machine with rigid drives: none."""
    none = np.zeros(0, int)
    return Rotors(none, none, np.zeros((0, joints)), np.eye(joints))


def rotors_of(m: mujoco.MjModel, joints: Sequence[str]) -> Rotors:
    """Return the rotors of a compiled machine whose n motors are in the order of its drives.

    Args:
        m: the machine.
        joints: names of its n serial joints.
    """
    springs = [_row(m, t) for t in range(m.ntendon) if "flex:" in m.tendon(t).name]
    names = [next(iter(row)) for row in springs]  # a spring's first joint is the rotor
    every = [*joints, *names]
    follow = np.zeros((len(names), len(joints)))
    for k, row in enumerate(springs):
        for joint, coefficient in list(row.items())[1:]:
            follow[k, joints.index(joint)] = -coefficient
    drives = np.zeros((m.nu, len(every)))
    for k in range(m.nu):
        target, gear = m.actuator_trnid[k, 0], m.actuator_gear[k, 0]
        on_tendon = m.actuator_trntype[k] == mujoco.mjtTrn.mjTRN_TENDON
        for joint, coefficient in (_row(m, target) if on_tendon else {m.joint(target).name: 1.0}).items():
            drives[k, every.index(joint)] = gear * coefficient
    return Rotors(
        places=np.array([m.joint(name).qposadr[0] for name in names], int),
        dofs=np.array([m.joint(name).dofadr[0] for name in names], int),
        follow=follow,
        drives=drives,
    )


def _row(m: mujoco.MjModel, tendon: int) -> Mapping[str, float]:
    """Coefficients of a fixed tendon by its joints' names, in their order."""
    first, count = m.tendon_adr[tendon], m.tendon_num[tendon]
    wraps = range(first, first + count)
    return {m.joint(m.wrap_objid[w]).name: float(m.wrap_prm[w]) for w in wraps}
