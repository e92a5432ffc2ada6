"""Unintended contacts between a base that is fixed to the world and the links that hang on it.

MuJoCo lets no body touch its own parent, since their shapes overlap about the joint; but a body that is fixed
to the world counts as the world, which all may touch. A robot whose free base is welded for a test stand thus
begins to collide with itself. Here parent and child never touch, whether their base is free or not. Pairs
that a file names by ``<pair>`` stay, and so does all that touches the world's own geoms, or a body that
carries nothing.
"""

from __future__ import annotations

from collections.abc import Iterator

import mujoco

_OURS = "fixed base: "


def keep_base_apart(spec: mujoco.MjSpec) -> None:
    """Exclude contacts of each fixed base with the links jointed to it, where their geoms could touch."""
    known = {frozenset((e.bodyname1, e.bodyname2)) for e in spec.excludes}
    for base, link in list(_jointed(spec)):
        if not any(_may_touch(one, other) for one in base.geoms for other in link.geoms):
            continue
        for body in (base, link):
            body.name = body.name or _new_name(spec)
        if frozenset((base.name, link.name)) not in known:
            exclude = spec.add_exclude(name=f"{_OURS}{base.name}, {link.name}")
            exclude.bodyname1, exclude.bodyname2 = base.name, link.name


def base_contacts(spec: mujoco.MjSpec) -> list[tuple[str, str]]:
    """Undo `keep_base_apart`; returns the pairs of bodies."""
    ours = [e for e in spec.excludes if e.name.startswith(_OURS)]
    pairs = [(e.bodyname1, e.bodyname2) for e in ours]
    for each in ours:
        spec.delete(each)
    return pairs


def machine_bodies(spec: mujoco.MjSpec) -> set[str]:
    """Names of bodies that move or carry what moves: all except the world and what only stands in it."""
    trees = [
        top for top in spec.worldbody.bodies if top.joints or any(b.joints for b in top.find_all("body"))
    ]
    return {body.name for top in trees for body in (top, *top.find_all("body"))}


def _jointed(spec: mujoco.MjSpec) -> Iterator[tuple[mujoco.MjsBody, mujoco.MjsBody]]:
    """Yield each body fixed to the world, with each link that joints connect to its base."""
    for top in spec.worldbody.bodies:
        if top.joints:
            continue
        base = list(_rigid(top))
        links = [link for body in base for child in body.bodies if child.joints for link in _rigid(child)]
        yield from ((body, link) for body in base for link in links)


def _rigid(body: mujoco.MjsBody) -> Iterator[mujoco.MjsBody]:
    """Yield a body and everything fixed to it."""
    yield body
    for child in body.bodies:
        if not child.joints:
            yield from _rigid(child)


def _may_touch(one: mujoco.MjsGeom, other: mujoco.MjsGeom) -> bool:
    return bool(one.contype & other.conaffinity or other.contype & one.conaffinity)


def _new_name(spec: mujoco.MjSpec) -> str:
    taken = {body.name for body in spec.bodies}
    return next(name for k in range(1, len(taken) + 2) if (name := f"body {k}") not in taken)
