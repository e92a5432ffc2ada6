"""Joints of a mechanism's tree that follow others or are held: equations beside those of its loops."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import mujoco

from workbench.core import Coupling, InputError, Mechanism
from workbench.core.bound_joints import BoundJoints


def couple(
    spec: mujoco.MjSpec, coupling: Coupling, solref: Sequence[float], solimp: Sequence[float], file: Path
) -> None:
    """Add a joint that follows another, as MuJoCo's own equality constraint.

    Raises:
        InputError: it follows by more than MuJoCo's polynomial of the fourth degree.
    """
    if len(coupling.polynomial) > 5:
        raise InputError(
            f"joint '{coupling.joint}' follows by {len(coupling.polynomial)} coefficients", file=file,
            column="closed_chain.couplings", remedy="give five at most",
        )  # fmt: skip
    bound = spec.add_equality(name=f"coupling:{coupling.joint}")
    bound.type, bound.objtype = mujoco.mjtEq.mjEQ_JOINT, mujoco.mjtObj.mjOBJ_JOINT
    bound.name1, bound.name2 = coupling.joint, coupling.follows or ""
    bound.data[:5] = [*coupling.polynomial, *[0.0] * (5 - len(coupling.polynomial))]
    bound.solref, bound.solimp = solref, solimp


def bound_joints(m: mujoco.MjModel, mechanism: Mechanism) -> BoundJoints:
    """Return a mechanism's couplings, for its tree in MuJoCo with loops cut open and no free base.

    Raises:
        InputError: a joint is not in the tree.
    """

    def place(name: str) -> int:
        number = mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_JOINT, name)
        if number >= 0:
            return int(m.jnt_dofadr[number])
        raise InputError(
            f"no joint is called '{name}'", file=mechanism.file, column="closed_chain.couplings",
            remedy="correct it",
        )  # fmt: skip

    return BoundJoints.of(mechanism.all_couplings(), place)
