"""Feet on the ground in MuJoCo: one contact pair per foot, with a law in N/m and N s/m.

MuJoCo softens a contact of penetration d, depth rate d' and normal acceleration a of the foot to

    force = (s d + b d' - i a) / ((1 - i) A),    solref = (-s, -b), solimp = (i, i, ...)

where A is what the engine takes for one over the foot's mass: the sum of the two bodies' `invweight0` (its
documentation, "Computation", soft constraints, with k, b and R written out). A is a constant of the compiled
model, whatever the posture, so that s = K (1 - i) A and b = C (1 - i) A make the force K d + C d', one-sided,
and as if a mass of i / ((1 - i) A) moved with the foot while it touches: with i = 0.001 a thousandth of its
own. It acts half-way between both surfaces. Friction lies in constraints of its own (elliptic cone): a spring
this soft would let a foot that holds creep, so that `impratio` makes them hard again; what is left is some
0.2 mm/s at 10 m/s^2.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from workbench.models import Ground

from .chain import Build

_IMPEDANCE = 1e-3  # share of the foot's mass by which a contact's force is late
_HARD = 1e5  # how much harder friction holds than the ground gives way
_STOP = 500.0  # 1/s: how fast friction stops a foot that holds
_PLANE, _FOOT = "ground", "foot:"


def lay_ground(build: Build, ground: Ground) -> None:
    """Put the ground, feet at sites, and one pair of both a foot into a spec; before any effect.

    What the table leaves open is what MuJoCo would take from both geoms.
    """
    spec = build.spec
    surface = ground.surface
    if surface is None:
        surface = _PLANE
        spec.worldbody.add_geom(
            name=surface, type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 0.1],
            pos=[0.0, 0.0, ground.height], contype=0, conaffinity=0,
        )  # fmt: skip
    for name in ground.feet:
        foot = _foot(spec, name, ground.radius)
        for pair in [p for p in spec.pairs if {p.geomname1, p.geomname2} == {surface, foot}]:
            spec.delete(pair)
        pair = spec.add_pair(name=f"{surface}:{foot}", geomname1=surface, geomname2=foot, condim=3)
        one, other = spec.geom(surface), spec.geom(foot)
        friction = np.array(_first(one, other).friction)
        if one.priority == other.priority:
            friction = np.maximum(one.friction, other.friction)
        pair.friction = [friction[0], friction[0], friction[1], friction[2], friction[2]]
        pair.solref, pair.solimp = _mixed(one, other)
        pair.margin = max(one.margin, other.margin)
        build.contacts.append(pair.name)
    if ground.friction is not None:
        set_friction(build, ground.friction)
    if ground.stiffness is not None and ground.damping is not None:
        build.contact_law = ground.stiffness, ground.damping


def lift_off(spec: mujoco.MjSpec, ground: Ground) -> None:
    """Remove all contacts of a model with its ground."""
    for geom in (ground.surface, *ground.feet):
        found = spec.geom(geom) if geom else None
        if found is not None:
            found.contype, found.conaffinity = 0, 0
            for pair in [p for p in spec.pairs if geom in (p.geomname1, p.geomname2)]:
                spec.delete(pair)


def set_friction(build: Build, coefficient: float) -> None:
    """Give all contacts with the ground a friction coefficient."""
    for name in build.contacts:
        build.spec.pair(name).friction[:2] = coefficient


def settle_contacts(build: Build) -> None:
    """Write the law of the contacts into the spec; after everything that changes a mass.

    Raises:
        ValueError, mujoco.FatalError: the spec cannot be compiled.
    """
    if build.contact_law is None or not build.contacts:
        return
    stiffness, damping = build.contact_law
    spec = build.spec
    compiled = spec.compile()
    for name in build.contacts:
        pair = spec.pair(name)
        bodies = [compiled.geom(geom).bodyid[0] for geom in (pair.geomname1, pair.geomname2)]
        give = (1.0 - _IMPEDANCE) * float(compiled.body_invweight0[bodies, 0].sum())
        pair.solref = [-max(stiffness * give, 1e-12), -max(damping * give, 1e-12)]
        pair.solimp = [_IMPEDANCE, _IMPEDANCE, 0.001, 0.5, 2.0]
        pair.solreffriction = [-1e-12, -_STOP * _IMPEDANCE]
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = _HARD


def add_force_plate(build: Build) -> None:
    """Add one sensor per foot that measures the force of the ground on it; see `plate_columns`."""
    for name in build.contacts:
        pair = build.spec.pair(name)
        sensor = build.spec.add_sensor(
            name=name, type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=mujoco.mjtObj.mjOBJ_GEOM, objname=pair.geomname1,
            reftype=mujoco.mjtObj.mjOBJ_GEOM, refname=pair.geomname2,
        )  # fmt: skip
        sensor.intprm[:3] = 1 << int(mujoco.mjtConDataField.mjCONDATA_FORCE), _NET, 1


_NET = 3  # sum over the contacts of both geoms, in the world's frame


def plate_columns(m: mujoco.MjModel, contacts: Sequence[str]) -> np.ndarray:
    """Return the indices of MuJoCo's sensor data for the forces on the feet, (3 feet,)."""
    starts = [int(m.sensor(name).adr[0]) for name in contacts]
    return np.concatenate([np.arange(s, s + 3) for s in starts]) if starts else np.zeros(0, int)


def feet_of(m: mujoco.MjModel, contacts: Sequence[str]) -> list[tuple[int, int]]:
    """Return ground and foot of each contact, as numbers of geoms."""
    pairs = [m.pair(name) for name in contacts]
    return [(int(p.geom1[0]), int(p.geom2[0])) for p in pairs]


def contact_rates(m: mujoco.MjModel) -> tuple[float, float]:
    """Return the largest rates of a contact's spring and damper against its foot [1/s^2, 1/s]; zero without
    a law.
    """
    laws = [m.pair_solref[i] for i in range(m.npair) if m.pair_solref[i, 0] < 0]
    return tuple(np.max(-np.array(laws), axis=0)) if laws else (0.0, 0.0)


def _foot(spec: mujoco.MjSpec, name: str, radius: float | None) -> str:
    """The foot's geom; a sphere about the site where it is one."""
    site = spec.site(name)
    if site is None:
        return name
    geom = _FOOT + name
    site.parent.add_geom(
        name=geom, type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[radius, 0.0, 0.0], pos=site.pos,
        mass=0.0, contype=0, conaffinity=0,
    )  # fmt: skip
    return geom


def _mixed(one: mujoco.MjsGeom, other: mujoco.MjsGeom) -> tuple[np.ndarray, np.ndarray]:
    """Solver parameters of a contact of two geoms, as MuJoCo mixes them."""
    if one.priority != other.priority:
        chosen = _first(one, other)
        return np.array(chosen.solref), np.array(chosen.solimp)
    total = one.solmix + other.solmix
    share = one.solmix / total if total > 0 else 0.5
    solimp = share * np.array(one.solimp) + (1 - share) * np.array(other.solimp)
    both = np.array(one.solref), np.array(other.solref)
    standard = min(both[0][0], both[1][0]) > 0
    return (share * both[0] + (1 - share) * both[1] if standard else np.minimum(*both)), solimp


def _first(one: mujoco.MjsGeom, other: mujoco.MjsGeom) -> mujoco.MjsGeom:
    """The geom of the higher priority, which MuJoCo takes all of a contact from."""
    return one if one.priority > other.priority else other
