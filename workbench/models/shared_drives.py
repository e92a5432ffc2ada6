"""Actuators of an MJCF that move several joints through a tendon, and the transmission that results."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from workbench.core import InputError


def shared_drives(
    spec: mujoco.MjSpec, joints: list[str], file: Path
) -> tuple[tuple[str, ...], np.ndarray] | None:
    """Return drives of an MJCF whose actuators move several joints by a fixed tendon; None without one.

    Taken as one drive per joint, it would be another machine, of which every result is wrong.

    Args:
        spec: the tree, which compiles.
        joints: all that it has but those of a base that floats.
        file: it was read from.

    Returns:
        Names of the drives, and J (n, n) of q_p = J q_s: a drive turns as its tendon's length does.

    Raises:
        InputError: an actuator pulls along sites, or there are other than one drive for each joint.
    """
    tendon = mujoco.mjtTrn.mjTRN_TENDON
    if not any(actuator.trntype == tendon for actuator in spec.actuators):
        return None
    m = spec.compile()
    rows = [_row(m, k) for k in range(m.nu)]
    shared = [k for k in range(m.nu) if m.actuator_trntype[k] == tendon and len(rows[k]) != 1]
    if not shared:
        return None
    matrix = np.array([[row.get(name, 0.0) for name in joints] for row in rows])
    if len(rows) == len(joints) and np.linalg.matrix_rank(matrix) == len(joints):
        return tuple(m.actuator(k).name or f"drive{k + 1}" for k in range(m.nu)), matrix
    first = rows[shared[0]]
    moves = f"joints {' and '.join(first)} together" if first else "what its tendon passes along sites"
    raise InputError(
        f"actuator '{m.actuator(shared[0]).name}' moves {moves}, and it is not one drive for each joint",
        file=file, column="actuator",
        remedy="state [transmission] in a model file (docs/models.md): joints, and one matrix row per drive",
    )  # fmt: skip


def _row(m: mujoco.MjModel, actuator: int) -> dict[str, float]:
    """Return joint -> how far the actuator's coordinate turns with it; empty for tendons along sites."""
    kind, target = int(m.actuator_trntype[actuator]), int(m.actuator_trnid[actuator, 0])
    if kind == mujoco.mjtTrn.mjTRN_JOINT:
        return {m.joint(target).name: 1.0}
    if kind != mujoco.mjtTrn.mjTRN_TENDON:
        return {}
    return tendon_row(m, target)


def tendon_row(m: mujoco.MjModel, tendon: int) -> dict[str, float]:
    """Return joint -> how far a fixed tendon's length changes with it; empty for tendons along sites."""
    wraps = range(m.tendon_adr[tendon], m.tendon_adr[tendon] + m.tendon_num[tendon])
    if any(m.wrap_type[w] != mujoco.mjtWrap.mjWRAP_JOINT for w in wraps):
        return {}
    return {m.joint(int(m.wrap_objid[w])).name: float(m.wrap_prm[w]) for w in wraps}
