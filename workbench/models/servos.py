"""Position actuators of an MJCF: the gains of a loop that the file itself closes."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from .model import Model
from .spec import load_tree

_AFFINE, _FIXED = int(mujoco.mjtBias.mjBIAS_AFFINE), int(mujoco.mjtGain.mjGAIN_FIXED)
_NONE, _JOINT = int(mujoco.mjtDyn.mjDYN_NONE), int(mujoco.mjtTrn.mjTRN_JOINT)


@dataclass(frozen=True)
class Servos:
    """torque = kp (q_ref - q) - kd v of every joint, in steps of the file.

    `kp` [N m/rad or N/m], `kd` [N m s/rad or N s/m]: one per joint; `step`: of the file [s].
    """

    kp: tuple[float, ...]
    kd: tuple[float, ...]
    step: float


def servos_of(model: Model) -> Servos | None:
    """Return the position actuators of a model's file; None unless every joint has one, of its own.

    Actuators that filter their command, or have another law, are none.
    """
    if not np.array_equal(model.transmission, np.eye(model.size)):
        return None
    m = load_tree(model.serial).compile()
    found: dict[str, tuple[float, float]] = {}
    for a in range(m.nu):
        gear, gain, bias = float(m.actuator_gear[a, 0]), m.actuator_gainprm[a], m.actuator_biasprm[a]
        kinds = m.actuator_biastype[a], m.actuator_gaintype[a], m.actuator_dyntype[a], m.actuator_trntype[a]
        if kinds != (_AFFINE, _FIXED, _NONE, _JOINT) or bias[0] != 0.0 or not gain[0] == -bias[1] > 0.0:
            return None
        if gear != 1.0:
            return None  # its command is no angle of the joint
        found[m.joint(m.actuator_trnid[a, 0]).name] = float(gain[0]), -float(bias[2])
    if m.nu != len(found) or set(found) != set(model.joints):
        return None
    kp, kd = zip(*(found[name] for name in model.joints), strict=True)
    return Servos(kp, kd, float(m.opt.timestep))
