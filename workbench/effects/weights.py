"""Inertia without weight, and weight without inertia, as bodies of a plain MJCF.

In a tree the coupling inertia and the gravity torque of a link are tied to each other (M12 = l1 G2 / g);
in a parallelogram they are not. MuJoCo's gravity compensation unties them: a body with ``gravcomp = 1``
has inertia and no weight, and one of next to no mass with a large negative ``gravcomp`` has weight only.
On a fixed base that is exact. On a floating base the added mass also moves with the trunk.
"""

from __future__ import annotations

import mujoco
import numpy as np

from workbench.core import SimulationError
from workbench.models import Model

_FEATHER = 1e-7  # kg: 1e-9 kg m^2 at the links' lengths, a ten-millionth of the rotors' inertia
_ARM = 0.1  # m, where the weights hang; only the product with their force matters


def add_inertia(spec: mujoco.MjSpec, model: Model, m11: float, m12: float, m22: float) -> None:
    """Add kinetic energy m11 w1^2/2 + m12 cos(alpha) w1 w2 + m22 w2^2/2, without weight.

    A point mass m at the distance r along the shank gives m12 = m l1 r; what is missing then is rotary
    inertia of the two links. Any m between m12^2/(l1^2 m22) and m11/l1^2 does; the geometric mean is taken.

    Raises:
        SimulationError: the increments are not positive semidefinite, so no body has them.
    """
    thigh, shank, along, length = _links(spec, model)
    low = (m12 / length) ** 2 / m22 if m22 > 0 else np.inf
    high = m11 / length**2
    if not (m11 > 0 and m22 > 0 and low <= high * (1 + 1e-9)):
        raise SimulationError(
            f"linkage inertia M11={m11:.4g}, M12={m12:.4g}, M22={m22:.4g} kg m^2 is not positive semidefinite: "
            "no body has it; identify it again or correct the serial tree"
        )
    mass = float(np.sqrt(max(low, 1e-3 * high) * high))
    reach = m12 / (length * mass)
    _body(thigh, "linkage_thigh", np.zeros(3), _FEATHER, m11 - mass * length**2, 1.0)
    _body(shank, "linkage_shank", reach * along, mass, m22 - mass * reach**2, 1.0)


def add_gravity(spec: mujoco.MjSpec, model: Model, g1: float, g2: float) -> None:
    """Add the torques -g1 sin(q1) and -g2 sin(q2) in actuator coordinates, without inertia."""
    thigh, shank, along, length = _links(spec, model)
    gravity = float(np.linalg.norm(spec.option.gravity))
    if gravity == 0.0:
        raise SimulationError(f"model '{model.name}' has no gravity, so its linkage cannot have any")
    lower = g2 / _ARM
    upper = (g1 - lower * length) / _ARM
    for parent, name, force in ((thigh, "weight_thigh", upper), (shank, "weight_shank", lower)):
        _body(parent, name, _ARM * along, _FEATHER, 0.0, 1.0 - force / (_FEATHER * gravity))


def _links(spec: mujoco.MjSpec, model: Model) -> tuple[mujoco.MjsBody, mujoco.MjsBody, np.ndarray, float]:
    thigh, shank = (spec.joint(name).parent for name in model.joints[:2])
    vector = np.asarray(shank.pos, float)
    length = float(np.linalg.norm(vector))
    return thigh, shank, vector / length, length


def _body(
    parent: mujoco.MjsBody, name: str, pos: np.ndarray, mass: float, inertia: float, gravcomp: float
) -> None:
    body = parent.add_body(name=name, pos=pos, gravcomp=gravcomp)
    body.explicitinertial, body.mass, body.ipos = True, mass, np.zeros(3)
    about = max(inertia, 1e-12)
    # a hinge feels only the inertia about its own axis; half of it about the others is a thin rod's
    body.inertia = np.array([0.5, 1.0, 0.5]) * about
