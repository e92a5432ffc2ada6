"""Inertia, gravity and velocity terms: engine against engine, each term of S3N against its source."""

from __future__ import annotations

import numpy as np

from workbench.core import Check
from workbench.effects import compile_plant
from workbench.models import Model
from workbench.s3n import Dynamics, closed_forms, reduced
from workbench.serial_tree import SerialTree

from .states import moving, relative
from .subject import Subject

EXACT = 1e-9  # relative: rounding, over some thousand operations


def engine_checks(subject: Subject) -> list[Check]:
    """Return the serial tree in MuJoCo against the same in Pinocchio."""
    q, v, tree = subject.states.position, subject.states.velocity, subject.tree
    ours = reduced(subject.plants["kin_only"], q, v)
    n = subject.model.size
    between = "MuJoCo, Pinocchio"
    mass, gravity = tree.mass_matrix(q)[:, :n, :n], tree.gravity(q)[:, :n]
    coriolis = tree.coriolis(q, v)[:, :n]
    return [
        Check("serial_mass_matrix", relative(ours.mass - mass, mass), EXACT, "", between),
        Check("serial_gravity", relative(ours.gravity - gravity, gravity), EXACT, "", between),
        Check(
            "serial_coriolis",
            relative(ours.bias - coriolis, np.append(coriolis, moving(ours.mass, v))),
            EXACT,
            "",
            between,
        ),
    ]


def actuator_checks(subject: Subject) -> list[Check]:
    """Return every drive's inertia counted once: on its joint, or behind the transmission."""
    model = subject.model
    inertia, damping = (np.array(x) for x in (model.actuators.inertia, model.actuators.damping))
    if not inertia.any():
        return []
    coupled = model.has("actuator_inertia_coupling")
    tree = SerialTree(model, compile_plant(model).mujoco)
    n, j = model.size, model.transmission
    wanted = closed_forms.pulled_back(inertia, j) if coupled else np.diag(inertia)
    found = tree.rotor_inertia[:n, :n]
    off = found - wanted
    out = [
        Check(
            "actuator_inertia",
            relative(off, wanted),
            EXACT,
            "",
            "MuJoCo, [actuators]",
            _counted_twice(off, inertia, model),
        )
    ]
    kin_only, s3n_act = (reduced(subject.plants[v], *_states(subject)) for v in ("kin_only", "s3n_act"))
    for name, gap, values in (
        ("actuator_pullback", s3n_act.mass - kin_only.mass, inertia),
        ("damping_pullback", s3n_act.damping - kin_only.damping, damping),
    ):
        closed = closed_forms.actuator_increment(values, j)
        scale = closed if np.abs(closed).max() > 0 else np.diag(values)
        out.append(Check(name, relative(gap - closed, scale), EXACT, "", "MuJoCo, closed form"))
    return out


def linkage_checks(subject: Subject) -> list[Check]:
    """Return the parallelogram: what the model states of its linkage against what Drake says that it is."""
    model, chain = subject.model, subject.chain
    assert model.linkage is not None and chain is not None
    q = subject.states.position
    n = model.size
    tree = subject.tree
    links = tree.link_mass_matrix(q)[:, :n, :n]
    back = np.linalg.inv(model.transmission)
    real = np.array([r.mass for r in subject.real])
    missing = back.T @ (real - links) @ back
    stated = closed_forms.parallel_inertia(model.linkage.M11, model.linkage.M12, model.linkage.M22, q[:, 1])
    off = stated - missing
    weight = (np.array([r.gravity for r in subject.real]) - tree.gravity(q)[:, :n]) @ back
    angles = q @ model.transmission.T
    pull = -np.array([model.linkage.g1, model.linkage.g2]) * np.sin(angles)
    parallel = back.T @ real @ back
    gravity = np.array([r.gravity for r in subject.real]) @ back
    allowed = max(EXACT, subject.tolerance)
    return [
        Check(
            "linkage_inertia",
            relative(off, parallel),
            allowed,
            "",
            "[linkage], Drake - tree",
            _linkage_hint(off, missing, model),
        ),
        Check(
            "linkage_gravity",
            relative(pull - weight, gravity),
            allowed,
            "",
            "[linkage], Drake - tree",
            f"the closed chain's weight is off by up to {np.abs(pull - weight).max():.3g} N m: "
            "[linkage] g1 or g2, or a mass of the serial tree",
        ),
        *_residual_forms(subject, links),
    ]


def _residual_forms(subject: Subject, links: np.ndarray) -> list[Check]:
    """Delta M_link by both expressions of the paper, Eq. 19: the actuator is subtracted once."""
    model = subject.model
    assert model.linkage is not None
    inertia = np.array(model.actuators.inertia)
    alpha, j = subject.states.position[:, 1], model.transmission
    increments = closed_forms.parallel_inertia(model.linkage.M11, model.linkage.M12, model.linkage.M22, alpha)
    back = np.linalg.inv(j)
    parallel_links = increments + back.T @ links @ back
    total = parallel_links + np.diag(inertia)
    from_links = closed_forms.residual_from_links(parallel_links, links)
    normalised = closed_forms.serial_inertia(links, inertia) + closed_forms.actuator_increment(inertia, j)
    from_total = closed_forms.residual_from_total(total, normalised)
    built = reduced(subject.plants["s3n_full"], *_states(subject)).mass
    wanted = normalised + from_links
    return [
        Check(
            "residual_inertia", relative(from_links - from_total, from_links), EXACT, "", "two closed forms"
        ),
        Check("s3n_full_inertia", relative(built - wanted, wanted), EXACT, "", "MuJoCo, closed form"),
    ]


def exact_checks(subject: Subject, exact: Dynamics) -> list[Check]:
    """Return the fully normalised tree against the closed chain: mass, gravity, velocity terms, power."""
    rotors = closed_forms.pulled_back(np.array(subject.model.actuators.inertia), subject.model.transmission)
    mass = np.array([r.mass for r in subject.real]) + rotors
    gravity, bias = (np.array([getattr(r, k) for r in subject.real]) for k in ("gravity", "bias"))
    allowed = max(EXACT, subject.tolerance)
    between = "MuJoCo, Drake"
    return [
        Check("mass_matrix", relative(exact.mass - mass, mass), allowed, "", between),
        Check("gravity", relative(exact.gravity - gravity, gravity), allowed, "", between),
        Check("coriolis", relative(exact.bias - bias, bias), allowed, "", between),
    ]


def _states(subject: Subject) -> tuple[np.ndarray, np.ndarray]:
    return subject.states.position, subject.states.velocity


def _counted_twice(off: np.ndarray, inertia: np.ndarray, model: Model) -> str:
    for k, joint in enumerate(model.joints):
        if off[k, k] > 0.01 * inertia.max():
            return (
                f"joint '{joint}' carries {off[k, k]:.4g} kg m^2 more rotor inertia than [actuators] gives: "
                "the actuator is counted twice (armature in the MJCF, or an effect given twice)"
            )
    return "the rotors are not those of [actuators]"


def _linkage_hint(off: np.ndarray, missing: np.ndarray, model: Model) -> str:
    worst = np.abs(off).max(axis=0)
    i, j = np.unravel_index(int(np.argmax(worst)), worst.shape)
    name = {(0, 0): "M11", (1, 1): "M22"}.get((int(i), int(j)), "M12")
    mean = float(off[:, i, j].mean())
    inertia = model.actuators.inertia[i]
    if i == j and inertia and abs(mean - inertia) < 0.1 * inertia:
        return f"{name} is too large by the actuator's inertia ({inertia:.4g} kg m^2), which is counted twice"
    return (
        f"{name} is off by up to {worst[i, j]:.3g} kg m^2 (closed chain less serial tree: "
        f"{missing[0, i, j]:.6g} at the first posture): [linkage], a length or a mass differs"
    )
