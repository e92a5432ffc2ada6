"""All checks of one model, in the order in which one would look for a fault."""

from __future__ import annotations

import numpy as np

from workbench.core import InputError, Verification, WorkbenchError
from workbench.effects.structure import is_parallelogram
from workbench.models import Model
from workbench.s3n import explicit_spectral_radius, floating_base_error, reduced, variant_dynamics
from workbench.s3n.posture import MOST_DRIVES

from .kinematics import kinematic_checks
from .motion import frf_check, motion_check
from .posture import fitted_facts, posture_checks
from .power import power_checks
from .structure import actuator_checks, engine_checks, exact_checks, linkage_checks
from .subject import Subject

_ALPHA = np.arange(0.0, 181.0, 15.0)  # deg


def verify(model: Model, *, samples: int = 50, seed: int = 0, tolerance: float = 1e-9) -> Verification:
    """Hold a model's serial tree, its variants and its closed chain against each other.

    Args:
        model: the model; effects that are not structural are left out.
        samples: random postures and speeds within the limits.
        seed: of these.
        tolerance: largest relative difference between [linkage] and the closed chain: near rounding where
            both are the same mechanism, more where one is CAD and the other was identified.

    Raises:
        InputError: the base floats, or the closed chain cannot be read.
    """
    subject = Subject.of(model.on_its_stand("a check of serial trees"), samples, seed, tolerance)
    checks, skipped = kinematic_checks(subject), []
    if subject.left_out:
        skipped.append(
            f"{', '.join(subject.left_out)}: effects outside the structure of S3N are not checked here"
        )
    skipped += subject.beyond
    if subject.unreached:
        left = f"{subject.unreached} of {samples} random states within the limits"
        skipped.append(f"{left}: the closed chain cannot reach them")
    right = all(c.passed for c in checks if c.name == "transmission")
    checks += engine_checks(subject)
    checks += power_checks(subject)
    if not right:
        skipped.append("inertia and gravity of the closed chain: the transmission is wrong")
        return Verification(model.name, tuple(checks), not_checked=tuple(skipped))
    checks += actuator_checks(subject)
    try:
        facts = _free_base(subject)
    except WorkbenchError as error:  # the fixed base is what was checked
        facts = {}
        skipped.append(f"the exact variant on a free base: {error}")
    if subject.chain is None:
        skipped.append("the closed chain: the model has no [closed_chain]")
    elif subject.model.posture_dependent:
        try:
            checks += posture_checks(subject, seed)
            if subject.model.size > MOST_DRIVES:
                skipped.append(
                    f"motion, frequency response, all of the workspace: with more than {MOST_DRIVES} "
                    "drives, terms are compared at random states only; import each limb by itself for "
                    "these"
                )
            elif all(check.passed for check in checks):
                facts |= fitted_facts(subject)
        except InputError as error:
            skipped.append(f"what depends on the posture: {error}")
    elif not is_parallelogram(subject.model):
        skipped.append("linkage inertia and gravity: the model states no parallelogram ([linkage])")
    else:
        checks += linkage_checks(subject)
        q, v = subject.states.position, subject.states.velocity
        checks += exact_checks(subject, reduced(subject.plants["exact"], q, v))
        checks += [frf_check(subject), motion_check(subject, seed)]
    alpha, radius = _explicit(subject.model)
    return Verification(
        model.name,
        tuple(checks),
        variants=_variants(subject),
        alpha_deg=alpha,
        radius=radius,
        facts=facts,
        not_checked=tuple(skipped),
    )


def _free_base(subject: Subject) -> dict[str, tuple[float, str, str]]:
    """What the exact variant gets wrong once its base is free, as a leg of a robot that walks.

    Raises:
        InputError: the closed chain is no SDF.
        SimulationError: a loop cannot be closed within the limits.
    """
    if "exact" not in subject.plants or subject.chain is None:
        return {}
    error = floating_base_error(subject.model, "exact")
    about = "On a free base, the exact variant differs from the closed chain: "
    return {
        "free_base_mass": (error.mass - error.true_mass, "kg", f"{about}mass by"),
        "free_base_coupling": (100.0 * error.coupling, "%", f"{about}coupling between base and joints by"),
        "free_base_inertia": (100.0 * error.inertia, "%", f"{about}inertia by"),
    }


def _variants(subject: Subject) -> dict[str, tuple[float, float, float]]:
    """Mass matrix of two-axis variants at alpha = 90 degrees, which is an angle of a parallelogram."""
    if subject.model.size != 2 or subject.model.posture_dependent:
        return {}
    if subject.model.closed_chain is None and subject.model.linkage is None:  # a plain arm has no such angle
        return {}
    names = [*subject.plants, *(["s3n_full_paper"] if "s3n_full" in subject.plants else [])]
    q, v = np.array([[0.0, np.pi / 2]]), np.zeros((1, 2))
    out = {}
    for name in names:
        mass = variant_dynamics(subject.model, name, q, v).mass[0]
        out[name] = (float(mass[0, 0]), float(mass[0, 1]), float(mass[1, 1]))
    return out


def _explicit(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Knee angles [deg] and the explicit variant's radius there; empty where there is no such variant."""
    try:
        return _ALPHA, explicit_spectral_radius(model, np.radians(_ALPHA))
    except InputError:
        return np.zeros(0), np.zeros(0)
