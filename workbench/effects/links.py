"""Bodies of the joints: mass, centre, inertia, and the torque that an error of these requires."""

from __future__ import annotations

from collections.abc import Callable, Container
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import mujoco
import numpy as np

from workbench.models import Inertial, Model, Placement, load_tree

from .chain import Build
from .motion import LinkMotion, Motion

_NO_WAY = 1e-9  # m: two points that coincide
_NO_TURN = 1e-12  # kg m^2: a point that has a mass


@dataclass(frozen=True)
class Link:
    """The body of an axis; `hinge` stands for a slide too.

    Attributes:
        body: its name.
        inertial: what its file says of it.
        anchor: a point of the hinge, and `axis`, its direction, (3,) each, in the body's frame.
        along: unit vector from the hinge to the next joint, the payload or the centre of mass, square to the
            axis; `across`: a quarter turn about the axis from it.
        size: how far its mass may reach from the hinge [m].
        slides: whether its axis slides; then where its centre is acts on the axes before it alone.
        mass_alone: whether its mass does what no rotor does: another axis moves it, its slide lifts it, or
            its weight turns its hinge.
    """

    body: str
    inertial: Inertial
    anchor: np.ndarray
    axis: np.ndarray
    along: np.ndarray
    across: np.ndarray
    size: float
    slides: bool
    mass_alone: bool


def link_of(model: Model, axis: str | None) -> Link | None:
    """Return the link of an axis; None if it shares its body with a later axis, or has no mass."""
    if axis is None:
        return None
    links = _links(*model.links, model.payload_site)
    return links[model.axes.index(axis)]


def link_with(model: Model, site: str) -> str | None:
    """Return the axis whose link carries a site; None if the site is on no link."""
    body = load_tree(model.links[0]).site(site).parent
    links = dict(zip(model.axes, _links(*model.links, model.payload_site), strict=True))
    while body is not None:  # what is welded to a link is a part of it
        for axis, link in links.items():
            if link is not None and link.body == body.name:
                return axis
        body = body.parent
    return None


def link_at(model: Model, place: Placement) -> Link:
    """Return the link of a place where an effect of links applies."""
    link = link_of(model, model.axes[place.index])
    assert link is not None
    return link


def link_ends(model: Model) -> tuple[str | None, ...]:
    """Return the end of each axis' link: a joint by name, the payload site (empty), or nothing (None)."""
    return _ends(*model.links, model.payload_site)


def reshape(build: Build, link: Link, change: Callable[[Inertial], Inertial]) -> None:
    """Give a link another inertial; several changes of one link are combined."""
    now = change(build.inertials.get(link.body, link.inertial))
    build.inertials[link.body] = now
    body = build.links.body(link.body)
    principal, axes = np.linalg.eigh(now.tensor)
    axes *= np.sign(np.linalg.det(axes))
    body.explicitinertial, body.mass, body.ipos = True, now.mass, now.centre
    body.fullinertia = np.full(6, np.nan)
    body.ialt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
    mujoco.mju_mat2Quat(quat := np.zeros(4), axes.ravel())
    body.iquat, body.inertia = quat, _possible(principal, axes, link.axis)


def with_moment(inertial: Inertial, moment: np.ndarray) -> Inertial:
    """Return the inertial with a further first moment (3,) [kg m]: the same mass with another centre."""
    return replace(inertial, centre=inertial.centre + moment / inertial.mass)


def own_inertia(inertial: Inertial, link: Link) -> float:
    """Return an inertia about the parallel to a link's axis through its own centre of mass [kg m^2]."""
    return float(link.axis @ inertial.tensor @ link.axis)


def in_proportion(inertial: Inertial, link: Link, more: float) -> np.ndarray:
    """Return the inertia (3, 3) with `more` [kg m^2] about the link's axis, and others in proportion."""
    own = own_inertia(inertial, link)
    if own > _NO_TURN:
        return inertial.tensor * (1.0 + more / own)
    return inertial.tensor + more * np.outer(link.axis, link.axis)


def _possible(principal: np.ndarray, axes: np.ndarray, about: np.ndarray) -> np.ndarray:
    """Principal moments that a body can have: none is more than the others together.

    The moment about the hinge stays; what turns another way gives in.
    """
    moments = np.maximum(principal, 1e-12)
    excess = 2.0 * moments.max() - moments.sum()
    if excess <= 0.0:
        return moments
    excess *= 1.0 + 1e-9  # on the safe side of rounding
    top = int(moments.argmax())
    if abs(axes[:, top] @ about) < np.sqrt(0.5):
        moments[top] -= excess
    else:
        moments[np.arange(3) != top] += 0.5 * excess
    return moments


def turning(motion: Motion, axis: int, tensor: np.ndarray) -> np.ndarray:
    """Return the torque (N, n) that a link needs for a further inertia (3, 3) about its centre, in its
    frame.
    """
    link = motion.link(axis)
    world = link.rotation @ tensor @ np.swapaxes(link.rotation, 1, 2)
    w = np.einsum("kij,kj->ki", link.turn, motion.velocity)
    momentum = np.einsum("kij,kj->ki", world, w)
    needed = np.einsum("kij,kj->ki", world, link.spin_up) + np.cross(w, momentum)
    return np.einsum("kij,ki->kj", link.turn, needed)


def carrying(motion: Motion, link: LinkMotion, centre: np.ndarray) -> np.ndarray:
    """Return the torque (N, n) that a link needs for 1 kg more at a point (3,), in its frame."""
    w = np.einsum("kij,kj->ki", link.turn, motion.velocity)
    out = link.rotation @ centre
    pushed = link.rise - motion.gravity + np.cross(link.spin_up, out) + np.cross(w, np.cross(w, out))
    return np.einsum("kij,ki->kj", link.move, pushed) + np.einsum(
        "kij,ki->kj", link.turn, np.cross(out, pushed)
    )


def leaning(motion: Motion, link: LinkMotion, way: np.ndarray) -> np.ndarray:
    """Return the torque (N, n) that a link needs for a further first moment of 1 kg m along `way` (3,), in
    its frame.

    By a mass about its own origin, whose inertia about the origin stays.
    """
    w = np.einsum("kij,kj->ki", link.turn, motion.velocity)
    out = link.rotation @ way
    pushed = np.cross(link.spin_up, out) + np.cross(w, np.cross(w, out))
    turned = np.cross(out, link.rise - motion.gravity)
    return np.einsum("kij,ki->kj", link.move, pushed) + np.einsum("kij,ki->kj", link.turn, turned)


def shifting(motion: Motion, axis: int, way: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Return the torque (N, n) that a link needs for a further first moment of 1 kg m along `way`, in
    its frame.

    By a mass of which the centre moves, so that the inertia about the hinge goes with it.
    """
    outer = np.outer(centre, way)
    grown = 2.0 * (centre @ way) * np.eye(3) - outer - outer.T
    return leaning(motion, motion.link(axis), way) + turning(motion, axis, grown)


@lru_cache(maxsize=64)
def _links(serial: Path, joints: tuple[str, ...], payload_site: str | None) -> tuple[Link | None, ...]:
    m = load_tree(serial).compile()
    data = mujoco.MjData(m)
    mujoco.mj_kinematics(m, data)
    bodies = {name: int(m.joint(name).bodyid[0]) for name in joints}
    nearest = {body: name for name, body in bodies.items()}
    ends = _ends(serial, joints, payload_site)
    return tuple(
        _link(m, data, name, joints, end, payload_site)
        if nearest[bodies[name]] == name and m.body_mass[bodies[name]] > 0.0
        else None
        for name, end in zip(joints, ends, strict=True)
    )


def _link(
    m: mujoco.MjModel,
    data: mujoco.MjData,
    joint: str,
    joints: tuple[str, ...],
    end: str | None,
    payload_site: str | None,
) -> Link:
    j, body = m.joint(joint), int(m.joint(joint).bodyid[0])
    inertial = Inertial.of(m, body)
    axis, anchor = np.array(j.axis, float), np.array(j.pos, float)
    rotation = data.xmat[body].reshape(3, 3)
    ways = [inertial.centre - anchor, np.eye(3)[int(np.abs(axis).argmin())]]
    if end is not None:
        far = data.site(payload_site).xpos if end == "" else data.xanchor[m.joint(end).id]
        ways.insert(0, rotation.T @ (far - data.xanchor[j.id]))
    square = [way - (way @ axis) * axis for way in ways]
    along = next(way for way in square if np.linalg.norm(way) > _NO_WAY)
    along = along / np.linalg.norm(along)
    gyration = float(np.sqrt(np.trace(inertial.tensor) / inertial.mass))
    size = 2.0 * max(*(float(np.linalg.norm(way)) for way in square[:-1]), gyration)
    carried = _carrier(m, int(m.body_parentid[body]), {int(m.joint(name).bodyid[0]) for name in joints}) > 0
    slides = bool(j.type[0] == mujoco.mjtJoint.mjJNT_SLIDE)
    gravity = m.opt.gravity @ rotation
    lifted = slides and abs(gravity @ axis) > _NO_WAY
    off = float(np.linalg.norm(square[-2]))  # the centre of mass, from the axis
    weighs = not slides and float(np.linalg.norm(np.cross(gravity, axis))) * off > _NO_WAY
    return Link(
        *(m.body(body).name, inertial, anchor, axis, along, np.cross(axis, along), size),
        *(slides, carried or lifted or weighs),
    )


def _carrier(m: mujoco.MjModel, body: int, links: Container[int]) -> int:
    """The link that a body belongs to; the world, if to none."""
    while body and body not in links:
        body = int(m.body_parentid[body])
    return body


@lru_cache(maxsize=64)
def _ends(serial: Path, joints: tuple[str, ...], payload_site: str | None) -> tuple[str | None, ...]:
    m = load_tree(serial).compile()
    links = {name: int(m.joint(name).bodyid[0]) for name in joints}
    last = {link: name for name, link in links.items()}  # of several joints of a body, the one next to it
    site = m.site(payload_site) if payload_site else None
    out: list[str | None] = []
    for name, link in links.items():
        further = [b for b in last if _carrier(m, int(m.body_parentid[b]), last) == link]
        at_end = site is not None and _carrier(m, int(site.bodyid[0]), last) == link and np.any(site.pos)
        if last[link] != name or len(further) > 1:
            out.append(None)
        elif further:
            out.append(last[further[0]] if np.any(m.body_pos[further[0]]) else None)
        else:
            out.append("" if at_end else None)
    return tuple(out)
