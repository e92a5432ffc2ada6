"""A drive that is stated twice: in the model file, and again at the joint that it turns."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np

from workbench.core import InputError

from .model import Actuators

_ALIKE = 1e-6  # of the number; nobody weighs a rotor better


def refuse_the_same_twice(
    spec: mujoco.MjSpec,
    joints: Sequence[str],
    matrix: np.ndarray,
    actuators: Actuators,
    file: Path,
) -> None:
    """What file and MJCF state adds up, which no one means where both state the same.

    Args:
        spec: the MJCF.
        joints: its joints, in the model's order, n.
        matrix: drives over joints, (n, n).
        actuators: the drives, as the file states them.
        file: the model file, for the message.

    Raises:
        InputError: a drive and the one joint that it turns have the same number.
    """
    for drive, row in enumerate(np.asarray(matrix)):
        turned = np.flatnonzero(row)
        if len(turned) != 1:
            continue
        joint = spec.joint(joints[turned[0]])
        for key, attribute, stated, there in (
            ("inertia", "armature", actuators.inertia[drive], float(joint.armature)),
            ("damping", "damping", actuators.damping[drive], float(np.ravel(joint.damping)[0])),
        ):
            at_drive = there / row[turned[0]] ** 2
            if stated > 0.0 and abs(stated - at_drive) <= _ALIKE * stated:
                raise InputError(
                    f"{stated:g} of drive {drive + 1} stands in the MJCF too, as {attribute} of joint "
                    f"'{joint.name}', and the two add up",
                    file=file,
                    column=f"actuators.{key}",
                    remedy="state it in one place",
                )
