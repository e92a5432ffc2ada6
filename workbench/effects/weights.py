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
from workbench.models import Crank, Model

from .flexible import rotor_name

_FEATHER = 1e-12  # kg: 1e-14 kg m^2 at the links' lengths, below rounding of what the links have
_ARM = 0.1  # m, where the weights hang; only the product with their force matters
NONE = Crank()


def add_inertia(
    spec: mujoco.MjSpec, model: Model, m11: float, m12: float, m22: float, crank: Crank = NONE
) -> None:
    """Add kinetic energy m11 w1^2/2 + m12 cos(alpha) w1 w2 + m22 w2^2/2, without weight.

    A point mass m at the distance r along the shank gives m12 = m l1 r; what is missing then is rotary
    inertia of the two links. Any m between m12^2/(l1^2 m22) and m11/l1^2 does; the geometric mean is taken.

    What is negative is taken from the links' own inertia. Where the shank's pin has a spring, `crank` is the
    part that turns on the motor's side of it.

    Raises:
        SimulationError: a link would be left without inertia.
    """
    thigh, shank, along, length = _links(spec, model)
    own, rest = masses_at_the_end(spec, length, m11, m12, m22, crank)
    if ahead := spec.body(rotor_name(1, "joint")):
        _swing(ahead, shank, model, along, own, crank.M12 / length, crank.M22)
        m12, m22 = m12 - crank.M12, m22 - crank.M22
    _turn(thigh, thigh, model.joints[0], m11 - (own + rest) * length**2)
    _swing(shank, shank, model, along, rest, m12 / length, m22)


def masses_at_the_end(
    spec: mujoco.MjSpec, length: float, m11: float, m12: float, m22: float, crank: Crank = NONE
) -> tuple[float, float]:
    """Return the point masses [kg] that `add_inertia` adds at the end of a thigh: on crank side and
    shank side.
    """
    if not spec.body(rotor_name(1, "joint")):
        return 0.0, _mass(length, m11, m12, m22)
    # as much as gives half of M22; the rest of it turns in place
    most = (2.0 * crank.M12) ** 2 / crank.M22 if crank.M22 > 0 else 0.0
    own = _mass(length, most, crank.M12, crank.M22)
    return own, _mass(length, m11 - own * length**2, m12 - crank.M12, m22 - crank.M22)


def _mass(length: float, m11: float, m12: float, m22: float) -> float:
    low = (m12 / length) ** 2 / m22 if m22 > 0 else np.inf
    high = m11 / length**2
    return float(np.sqrt(low * high)) if 0 < low <= high else max(abs(m12) / (length * _ARM), _FEATHER)


def _swing(
    carrier: mujoco.MjsBody, shank: mujoco.MjsBody, model: Model, along: np.ndarray,
    mass: float, moment: float, inertia: float,
) -> None:  # fmt: skip
    """Hang a mass on what turns at the thigh's end, for a first moment [kg m] and an inertia there."""
    reach = moment / mass
    _turn(carrier, shank, model.joints[1], inertia - mass * reach**2)
    _body(carrier, reach * along, mass, 0.0, 1.0)


def weight_at_the_end(g2: float) -> float:
    """Return the force [N] that `add_gravity` adds at the end of a thigh."""
    return g2 / _ARM


def _turn(carrier: mujoco.MjsBody, link: mujoco.MjsBody, joint: str, inertia: float) -> None:
    """Add rotary inertia: on `carrier` where it is positive, else by taking it from the link's own."""
    if inertia >= 0.0:
        _body(carrier, np.zeros(3), _FEATHER, inertia, 1.0)
        return
    x, y, z = np.asarray(link.inertia, float)
    left = y + inertia
    if not np.isfinite(left) or left <= 0.0:
        raise SimulationError(
            f"the linkage would take {-inertia:.4g} kg m^2 from the link of joint '{joint}', "
            f"which has {y:.4g}: no body has such an inertia; identify it again or correct the serial tree"
        )
    # the inertia about the other axes follows as far as a body's has to
    link.inertia = np.array([np.clip(x, abs(left - z), left + z), left, z])


def add_gravity(spec: mujoco.MjSpec, model: Model, g1: float, g2: float, crank: Crank = NONE) -> None:
    """Add the torques -g1 sin(q1) and -g2 sin(q2) in actuator coordinates, without inertia.

    Where the shank's pin has a spring, `crank` is the part that hangs on the motor's side of it.
    """
    thigh, shank, along, length = _links(spec, model)
    gravity = float(np.linalg.norm(spec.option.gravity))
    if gravity == 0.0:
        raise SimulationError(f"model '{model.name}' has no gravity, so its linkage cannot have any")
    lower = weight_at_the_end(g2)
    upper = (g1 - lower * length) / _ARM
    hung = [(thigh, upper), (shank, lower)]
    if ahead := spec.body(rotor_name(1, "joint")):
        own = weight_at_the_end(crank.g2)
        hung = [(thigh, upper), (shank, lower - own), (ahead, own)]
    for parent, force in hung:
        _body(parent, _ARM * along, _FEATHER, 0.0, 1.0 - force / (_FEATHER * gravity))
    # MuJoCo leaves gravity compensation out altogether where no body's is above zero
    _body(thigh, np.zeros(3), _FEATHER, 0.0, 1.0)


def _links(spec: mujoco.MjSpec, model: Model) -> tuple[mujoco.MjsBody, mujoco.MjsBody, np.ndarray, float]:
    thigh, shank = (spec.joint(name).parent for name in model.joints[:2])
    vector = np.asarray(shank.pos, float)
    with np.errstate(over="ignore"):
        length = float(np.linalg.norm(vector))
    if not 0.0 < length < np.inf:
        raise SimulationError(
            f"the link of joint '{model.joints[0]}' is {length:g} m long: no place for a linkage"
        )
    return thigh, shank, vector / length, length


def _body(parent: mujoco.MjsBody, pos: np.ndarray, mass: float, inertia: float, gravcomp: float) -> None:
    body = parent.add_body(pos=pos, gravcomp=gravcomp)
    body.explicitinertial, body.mass, body.ipos = True, mass, np.zeros(3)
    about = max(inertia, 1e-12)
    # a hinge feels only the inertia about its own axis; half of it about the others is a thin rod's
    # (a little more, so that no rounding makes it a body that cannot be)
    body.inertia = np.array([0.5 + 1e-9, 1.0, 0.5 + 1e-9]) * about
