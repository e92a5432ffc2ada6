"""Actuators of an MJCF that move several joints at once, by a tendon: a model file has to say how."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from workbench.core import InputError


def refuse_shared_drives(spec: mujoco.MjSpec, joints: list[str], file: Path) -> None:
    """Refuse an MJCF in which one actuator moves several joints, where nothing states the transmission.

    Taken as one drive a joint, it would be another machine, of which every result is wrong.

    Args:
        spec: the tree, which compiles.
        joints: those that are taken to have a drive each.
        file: it was read from.

    Raises:
        InputError: there is such an actuator.
    """
    tendon = mujoco.mjtTrn.mjTRN_TENDON
    if not any(actuator.trntype == tendon for actuator in spec.actuators):
        return
    m = spec.compile()
    rows = {k: _row(m, k) for k in range(m.nu)}
    shared = [k for k in range(m.nu) if m.actuator_trntype[k] == tendon and len(rows[k]) != 1]
    if not shared:
        return
    first = m.actuator(shared[0])
    moves = (
        f"joints {' and '.join(rows[shared[0]])} together" if rows[shared[0]] else "what its tendon passes"
    )
    matrix = [[rows[k].get(name, 0.0) for name in joints] for k in range(m.nu)]
    square = len(matrix) == len(joints) and np.linalg.matrix_rank(np.array(matrix)) == len(joints)
    named = ", ".join(f'"{name}"' for name in joints)
    written = "[" + ", ".join(f"[{', '.join(f'{x:g}' for x in row)}]" for row in matrix) + "]"
    raise InputError(
        f"actuator '{first.name}' moves {moves}, and is no drive of one joint",
        file=file,
        column="actuator",
        remedy=f'state in a model file (.toml): serial = "{file.name}"; [transmission] joints = [{named}], '
        f"matrix = {written if square else 'a row a drive'}",
    )


def _row(m: mujoco.MjModel, actuator: int) -> dict[str, float]:
    """Joint -> how the actuator's coordinate turns with it; nothing of what passes along sites."""
    kind, target = int(m.actuator_trntype[actuator]), int(m.actuator_trnid[actuator, 0])
    if kind == mujoco.mjtTrn.mjTRN_JOINT:
        return {m.joint(target).name: 1.0}
    if kind != mujoco.mjtTrn.mjTRN_TENDON:
        return {}
    wraps = range(m.tendon_adr[target], m.tendon_adr[target] + m.tendon_num[target])
    if any(m.wrap_type[w] != mujoco.mjtWrap.mjWRAP_JOINT for w in wraps):
        return {}
    return {m.joint(int(m.wrap_objid[w])).name: float(m.wrap_prm[w]) for w in wraps}
