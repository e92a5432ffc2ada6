"""A fitted mechanism written into its serial tree as plain MJCF: inertials, tendons, sites and springs."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from workbench.models import Model

from .posture_length import Branches
from .posture_links import Body
from .posture_native import CONSTANT, Fit


def write_fit(found: Fit, spec: mujoco.MjSpec) -> list[str]:
    """Write a fit into the model's own MJCF; return each drive's tendon, empty if a joint is the drive."""
    model, carried = found.chain.model, found.carried
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_AUTO
    for name, link in zip(found.bodies[1:], carried.links, strict=True):
        _inertial(spec.body(name), link)
    for k, (value, row) in enumerate(_rank_ones(carried.rotors)):
        only = np.flatnonzero(row)
        if len(only) == 1:
            spec.joint(model.joints[only[0]]).armature += value
        else:
            _fixed(spec, model, f"links:{k}", row).armature = value
    names = []
    for i, (axis, branches) in enumerate(zip(model.axes, found.tendons, strict=True)):
        row = found.rows[i]
        alone = branches is None and np.count_nonzero(np.abs(row) > CONSTANT) == 1
        spring = _spring(carried.springs[found.springs.index(("drive", i))])
        if alone and spring is None:
            joint = spec.joint(model.joints[int(np.abs(row).argmax())])
            ratio = float(row[np.abs(row).argmax()])
            joint.armature += ratio**2 * (found.chain.inertia[i] + carried.drives[i])
            joint.damping[0] += ratio**2 * found.chain.damping[i]
            names.append("")
            continue
        names.append(axis if all(t.name != axis for t in spec.tendons) else f"{axis}_drive")
        if branches is None:
            tendon = _fixed(spec, model, names[-1], np.where(np.abs(row) > CONSTANT, row, 0.0))
        else:
            tendon = _in_space(spec, found, names[-1], branches)
        tendon.armature = found.chain.inertia[i] + carried.drives[i]
        tendon.damping[0] = found.chain.damping[i]
        _tense(tendon, spring)
    for (kind, k), coefficients in zip(found.springs, carried.springs, strict=True):
        spring = _spring(coefficients)
        if kind == "joint" and spring is not None:
            _tense(_fixed(spec, model, f"weight:{model.joints[k]}", np.eye(model.size)[k]), spring)
    return names


def _inertial(body: Any, link: Body) -> None:
    body.explicitinertial, body.mass, body.ipos, body.gravcomp = True, link.mass, link.centre, 0.0
    body.iquat, body.inertia = [1.0, 0.0, 0.0, 0.0], np.zeros(3)
    i = link.inertia
    body.fullinertia = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]


def _rank_ones(matrix: np.ndarray) -> list[tuple[float, np.ndarray]]:
    """Return a positive semidefinite matrix as a sum of value times row^T row, single joints if possible."""
    left, out = matrix.copy(), []
    for i in range(len(left)):
        value = float(left[i, i])
        if value > 1e-9 * max(np.trace(matrix), 1e-300):
            row = np.where(np.arange(len(left)) >= i, left[i] / value, 0.0)
            row[np.abs(row) < 1e-9] = 0.0
            out.append((value, row))
            left = left - value * np.outer(row, row)
    return out


def _fixed(spec: mujoco.MjSpec, model: Model, name: str, row: np.ndarray) -> Any:
    tendon = spec.add_tendon(name=name)
    for joint, coefficient in zip(model.joints, row, strict=True):
        if coefficient:
            tendon.wrap_joint(joint, float(coefficient))
    return tendon


def _in_space(spec: mujoco.MjSpec, found: Fit, name: str, branches: Branches) -> Any:
    """Add a tendon of branches between new sites, each behind a pulley that applies its weight; return it."""
    tendon = spec.add_tendon(name=name)
    tendon.rgba = [0.0, 0.0, 0.0, 0.0]
    rows = zip(branches.bodies, branches.points, branches.weights, strict=True)
    for k, (bodies, points, weight) in enumerate(rows):
        tendon.wrap_pulley(1.0 / float(weight))
        for end, (body, point) in enumerate(zip(bodies, points, strict=True)):
            carrier = spec.worldbody if body == 0 else spec.body(found.bodies[body])
            site = f"{name}:{k}{'ab'[end]}"
            carrier.add_site(name=site, pos=found.basis[body] @ point, group=5, size=[0.002, 0.002, 0.002])
            tendon.wrap_site(site)
    return tendon


def _spring(coefficients: np.ndarray) -> tuple[np.ndarray, float] | None:
    """Return stiffness (3,) and rest length of the spring whose torque has these coefficients of 1, x, x^2,
    x^3; None where all are zero.
    """
    largest = float(np.abs(coefficients).max())
    if largest == 0.0:
        return None
    c = coefficients.copy()
    roots = _real_roots(c)
    if len(roots) == 0:  # it pulls one way everywhere: a little of x^3 makes it end somewhere far away
        c[3] = 1e-3 * largest
        roots = _real_roots(c)
    rest = float(roots[np.abs(roots).argmin()])
    about = np.polynomial.Polynomial(c)(np.polynomial.Polynomial([rest, 1.0])).coef
    stiffness = np.zeros(3)
    stiffness[: len(about) - 1] = -about[1:]
    return stiffness, rest


def _real_roots(coefficients: np.ndarray) -> np.ndarray:
    trimmed = np.trim_zeros(coefficients, "b")
    roots = np.polynomial.polynomial.polyroots(trimmed) if len(trimmed) > 1 else np.zeros(0)
    return np.real(roots[np.abs(np.imag(roots)) < 1e-9])


def _tense(tendon: Any, spring: tuple[np.ndarray, float] | None) -> None:
    if spring is not None:
        tendon.stiffness, tendon.springlength = spring[0], [spring[1], spring[1]]
