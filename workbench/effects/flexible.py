"""Drives and links that move apart: a coordinate of its own for the motor's side of an axis.

A rigid drive turns with a row of the transmission. Here its motor turns a joint of its own at the base,
which carries all that sits at the drive (its tendon: inertia, damping, friction, spring), and a tendon
couples it to the links by a spring. At a pin it is the coordinate of that pin which the transmission moves,
ahead of the joint of the links: every drive that turns with it turns with the new joint, and at the knee of
a parallelogram crank and coupler do. Where only one drive does, and nothing else, that is the same machine
as with the spring at the drive in other words.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import scipy
from scipy.linalg import expm

from workbench.core import EffectKey
from workbench.models import AppliedEffect, Model, Placement, axis_tendon, own_friction, rotors

from .base import is_rotary
from .chain import Build, FlankTerm
from .lacking import Lack
from .motion import Motion
from .parameter import Place
from .structure import crank_of, gravity_columns, inertia_columns

_RIGID = 200.0  # Hz: what rings faster, no loop and no log of a millisecond's rows tells from rigid
_NOTHING = 1e-9  # kg, kg m^2: what a joint's body must have, beside a rotor of 1e-2 kg m^2


def rotor_name(index: int, location: str) -> str:
    """Return the joint on the motor side of an axis."""
    return f"rotor:{location}:{index}"


def rotor_inertia(model: Model, index: int) -> float:
    """Return the inertia of a drive including corrections that were found [kg m^2 or kg]."""
    more = EffectKey("reflected_inertia", model.axes[index])
    own = _stated_drives(model)[0][index]
    return float(own) + sum(e.values["inertia"] for e in model.effects if e.key == more)


def _stated_drives(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Inertia and damping (n,) of drives, whatever effects they have."""
    if model.has("actuator_inertia_coupling"):
        return np.array(model.actuators.inertia), np.array(model.actuators.damping)
    return rotors(model)


def _without_drive(model: Model, index: int) -> Model:
    """A model without the effects of one drive."""
    here = model.axes[index], "actuator"
    links = tuple(e for e in model.effects if _seat(e.key) != here)
    # what the file states there no list of effects can leave out: the same once more, against it
    against = tuple(_negative(e) for e in own_friction(model) if _seat(e.key) == here)
    return (
        model if len(links) == len(model.effects) and not against else replace(model, effects=links + against)
    )


def _negative(applied: AppliedEffect) -> AppliedEffect:
    parameters = {name: replace(e, value=-e.value) for name, e in applied.parameters.items()}
    return replace(applied, parameters=parameters)


def _seat(key: EffectKey) -> tuple[str | None, str]:
    return key.axis, key.location


def split(
    build: Build, model: Model, place: Placement, stiffness: float, damping: float, gap: float = 0.0
) -> None:
    """Give an axis a joint on its motor side and a spring to the links, before anything else is added
    there.
    """
    name = rotor_name(place.index, place.location)
    if place.location == "actuator":
        hinge, slide = mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE
        kind = hinge if is_rotary(model, model.axes[place.index]) else slide
        _add_joint(build.spec.worldbody, name, {"type": kind, "axis": [0.0, -1.0, 0.0]})
    else:
        # a tendon couples inertias of joints along one branch only, and other joints turn with a pin's drives
        pin = build.spec.joint(model.joints[place.index])
        like = {key: getattr(pin, key) for key in ("type", "axis", "pos", "ref")}
        body = _add_joint(pin.parent.parent, name, like)
        body.pos, body.quat = pin.parent.pos, pin.parent.quat
    if place.location == "actuator":
        own = axis_tendon(place.index)
        links, build.rows[own] = build.rows[own], {name: 1.0}
        _wrap_again(build, own)
    else:
        links = {model.joints[place.index]: 1.0}
        for index in range(model.size):
            row = build.rows[axis_tendon(index)]
            if model.joints[place.index] in row:
                row[name] = row.pop(model.joints[place.index])
                _wrap_again(build, axis_tendon(index))
    if not model.has("actuator_inertia_coupling"):
        _move_rotor(build, model, place, name)
    spring = build.spec.add_tendon(name=f"flex:{place.location}:{place.index}")
    spring.wrap_joint(name, 1.0)
    for joint, coefficient in links.items():
        spring.wrap_joint(joint, -coefficient)
    spring.stiffness[0], spring.damping[0] = stiffness, damping
    if gap and damping:
        build.chain.flanks.append(FlankTerm(spring.name, damping, 0.5 * gap))
    spring.springlength = np.array([-0.5, 0.5]) * gap


def _add_joint(parent: mujoco.MjsBody, name: str, like: Mapping[str, Any]) -> mujoco.MjsBody:
    body = parent.add_body(name=name, gravcomp=1.0)
    body.add_joint(name=name, **like)
    body.explicitinertial, body.mass, body.ipos = True, _NOTHING, np.zeros(3)
    body.inertia = np.full(3, _NOTHING)
    return body


def _wrap_again(build: Build, tendon: str) -> None:
    """A tendon over other joints; it must carry nothing yet."""
    build.spec.delete(build.spec.tendon(tendon))
    fresh = build.spec.add_tendon(name=tendon)
    for joint, coefficient in build.rows[tendon].items():
        fresh.wrap_joint(joint, coefficient)


def _move_rotor(build: Build, model: Model, place: Placement, name: str) -> None:
    """Without the coupling of actuators the drive's inertia sits on its serial joint: take it from there."""
    inertia, damping = (part[place.index] for part in rotors(model))
    joint, rotor = build.spec.joint(model.joints[place.index]), build.spec.joint(name)
    joint.armature = max(joint.armature - inertia, 0.0)
    joint.damping[0] = max(joint.damping[0] - damping, 0.0)
    rotor.armature, rotor.damping[0] = inertia, damping


def link_inertia(motion: Motion, model: Model, place: Placement) -> tuple[float, np.ndarray]:
    """Return the inertia behind a drive or a pin (mean over a motion), and its column at the drives,
    (N, n).
    """
    index = place.index
    column = motion.inertia()[:, :, index].copy()
    column[:, index] -= motion.rotor[0][index]
    if place.location == "joint" and index == 1:
        crank = crank_of(model)
        alpha = motion.position[:, 1] - motion.position[:, 0]
        column[:, 0] -= crank.M12 * np.cos(alpha)
        column[:, 1] -= crank.M22
    return float(column[:, index].mean()), column


def transmitted(motion: Motion, model: Model, place: Placement) -> np.ndarray:
    """Return the torque (N,) that a rigid model transmits: the required torque minus the part on the
    motor side.

    There is the drive's friction too, and all else that the model has found there.
    """
    index = place.index
    bare = _without_drive(model, index)
    inertia, damping = (part[index] for part in _stated_drives(model))
    needed = motion.required(bare)[:, index]
    torque = needed - inertia * motion.acceleration[:, index] - damping * motion.velocity[:, index]
    if place.location == "joint" and index == 1:
        crank = crank_of(model)
        coupling, own = inertia_columns(motion)[1:, :, 1]
        torque += crank.M12 * coupling + crank.M22 * own + crank.g2 * gravity_columns(motion)[1, :, 1]
    return torque


def spring_lack(motion: Motion, model: Model, place: Placement) -> tuple[Lack, float]:
    """Return what a motion requires of a spring behind a drive or in a pin, and the inertia on it."""
    inertia, column = link_inertia(motion, model, place)
    return Lack.of(motion, model, transmitted(motion, model, place), column), inertia


def spring_wind(
    torque: np.ndarray, step: float, inertia: float, stiffness: float, damping: float
) -> np.ndarray:
    """Return the second derivative (N,) of the deflection of a spring under the rigidly transmitted
    torque.

    The links lag behind the motor by the wind d, and what they need falls by their inertia times d'':
    inertia d'' + damping d' + stiffness d = torque.
    """
    change = np.array([[0.0, 1.0], [-stiffness / inertia, -damping / inertia]])
    # torque goes straight from row to row: held, it would come half a row late
    whole = np.zeros((4, 4))
    whole[:2, :2], whole[1, 2], whole[2, 3] = step * change, step / inertia, 1.0
    kept, held, later = np.split(expm(whole)[:2], [2, 3], axis=1)
    entry, straight = held - later + kept @ later, 1.0 / inertia + change[1] @ later[:, 0]
    # by hand: general conversions take far longer than the filter, and this is asked for very often
    (a, b), (c, d) = kept
    bottom = np.array([1.0, -(a + d), a * d - b * c])
    (x, y), (p, q) = change[1], entry[:, 0]
    top = straight * bottom + [0.0, x * p + y * q, x * (b * q - d * p) + y * (c * p - a * q)]
    return np.asarray(scipy.signal.lfilter(top, bottom, torque))


def free_wind(rows: int, step: float, inertia: float, stiffness: float, damping: float) -> np.ndarray:
    """Return the second derivative (rows, 2) of a free deflection, from an initial deflection and rate
    of one.
    """
    change = np.array([[0.0, 1.0], [-stiffness / inertia, -damping / inertia]])
    kept = expm(step * change)
    # a state that follows its own characteristic equation is a filter's answer to its first two values
    first = np.stack([change[1], change[1] @ kept])
    bottom = np.array([1.0, -float(np.trace(kept)), float(np.linalg.det(kept))])
    impulse = np.zeros(rows)
    impulse[0] = 1.0
    tops = [(a, b + bottom[1] * a) for a, b in first.T]
    return np.stack([scipy.signal.lfilter(top, bottom, impulse) for top in tops], axis=1)


def frequencies(motions: Sequence[Motion], slowest: float, fastest: float, count: int) -> np.ndarray:
    """Return rates [rad/s] between two frequencies [Hz], below what the rows resolve."""
    rate = min(fastest, 0.2 / motions[0].step)
    return 2.0 * np.pi * np.geomspace(min(slowest, 0.5 * rate), rate, count)


def stiffest(model: Model, place: Place) -> float:
    """Return the largest stiffness [N m/rad or N/m] that a fit needs to try: the rotor would resonate at
    `_RIGID`.
    """
    return rotor_inertia(model, place.index) * (2.0 * np.pi * _RIGID) ** 2
