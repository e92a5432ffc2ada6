"""Bodies that effects added to the links are merged into the links, which makes a step cheaper."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from .inertial import Inertial, about_a_fixed_axis, as_one, body_inertial

_NOTHING = 1e-18  # of a weight, below rounding


def merge_into_links(spec: mujoco.MjSpec, own: mujoco.MjSpec, m: mujoco.MjModel) -> None:
    """Merge what effects added to a user's tree, where one body can have the same inertia and weight.

    Args:
        spec: the user's tree with effects installed; changed in place.
        own: the user's tree alone.
        m: `spec`, compiled.
    """
    _say_every_inertia(spec, m)
    links = list(_links(spec.worldbody, own.worldbody))
    left: dict[int, float] = {}
    # leaves first: the weight that a link cannot carry acts on its parent
    for link in reversed(links):
        hung = [(child, left[child]) for child in link.children if left[child]]
        left[link.ident] = _merge(spec, m, link, hung)
    bodies = list(spec.bodies)[1:]
    if any(b.gravcomp < 0.0 for b in bodies) and not any(b.gravcomp > 0.0 for b in bodies):
        # MuJoCo looks at gravity compensation only where some body's is above zero
        free = next((b for b in bodies if b.gravcomp == 0.0), None)
        free = free or links[0].body.add_body(name="gravity compensation")
        free.gravcomp = _NOTHING


@dataclass(frozen=True)
class _Link:
    """One of the user's bodies, and what was added to it; numbers as compiled, which deleting changes."""

    body: mujoco.MjsBody
    ident: int
    children: list[int]
    added: list[tuple[mujoco.MjsBody, int]]


def _links(body: mujoco.MjsBody, own: mujoco.MjsBody) -> Iterator[_Link]:
    """The user's bodies below one, parents first."""
    for child, same in zip(body.bodies, own.bodies, strict=False):
        # an effect adds its bodies behind the user's
        inner, count = list(child.bodies), len(list(same.bodies))
        added = [(b, b.id) for b in inner[count:] if not list(b.joints)]
        yield _Link(child, child.id, [b.id for b in inner[:count]], added)
        yield from _links(child, same)


def _merge(spec: mujoco.MjSpec, m: mujoco.MjModel, link: _Link, hung: list[tuple[int, float]]) -> float:
    """Merge a link and what was added to it into one body; return the weight [kg] left to its parent."""
    if not link.added and not hung:
        return 0.0
    total = body_inertial(m, link.ident, in_parent=False)
    for _, ident in link.added:
        total = total + body_inertial(m, ident, in_parent=True)
    nothing = np.zeros(3)
    for child, weight in hung:
        total = total + Inertial(0.0, nothing, np.zeros((3, 3)), weight, weight * m.body_pos[child])
    found = _body(m, link.ident, total)
    name = link.body.name or f"body {link.ident}"
    if found is None:
        for number, (body, _) in enumerate(link.added):
            body.name = f"{name}:added:{number}"
        for number, (child, weight) in enumerate(hung):
            force = link.body.add_body(name=f"{name}:weight:{number}", pos=m.body_pos[child])
            # what is left over becomes the weight of a body of next to no mass
            _write(force, Inertial(1e-12, nothing, 1e-15 * np.eye(3), weight, nothing))
        return 0.0
    one, rest = found
    for body, _ in link.added:
        spec.delete(body)
    _write(link.body, one)
    return rest


def _body(m: mujoco.MjModel, link: int, total: Inertial) -> tuple[Inertial, float] | None:
    """Return the one body for a link and the weight left to its parent; None if there is none."""
    joints = slice(m.body_jntadr[link], m.body_jntadr[link] + m.body_jntnum[link])
    pivots = not np.any(m.jnt_pos[joints]) and np.all(m.jnt_type[joints] == mujoco.mjtJoint.mjJNT_HINGE)
    one = as_one(total)
    lifted = one is not None and one[0].gravcomp != 0.0
    fixed = m.body_parentid[link] == 0 and m.body_jntnum[link] == 1 and pivots
    if lifted and fixed:
        # a step costs less with a centre of mass in another place than with a weight to be lifted
        turned = about_a_fixed_axis(total)
        if turned is not None:
            return turned, 0.0
    if one is None or not one[0].is_body or (one[1] and not pivots):
        return None
    return one


def _write(body: mujoco.MjsBody, one: Inertial) -> None:
    """Set a spec body's inertial element and gravity compensation."""
    body.explicitinertial, body.gravcomp = True, one.gravcomp
    body.mass, body.ipos = one.mass, one.centre
    central = one.central
    if np.array_equal(central, np.diag(np.diag(central))):
        body.fullinertia = np.full(6, np.nan)
        body.iquat, body.inertia = np.array([1.0, 0.0, 0.0, 0.0]), np.diag(central)
        return
    i, body.inertia = central, np.zeros(3)
    body.fullinertia = np.array([i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]])


def _say_every_inertia(spec: mujoco.MjSpec, m: mujoco.MjModel) -> None:
    """Write out the inertias that the user's compiler took from geoms: links can have others now."""
    if spec.compiler.inertiafromgeom != mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE:
        return
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    for body in spec.bodies[1:]:
        one = body_inertial(m, body.id, in_parent=False)
        if one.mass > 0.0:
            _write(body, one)
