"""Step 2 of the workflow (paper, Algorithm 1): S3N-Act and S3N-Full from what was identified."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.core import InputError
from workbench.models import VARIANTS, AppliedEffect, Linkage, Model
from workbench.s3n import with_variant
from workbench.s3n.closed_forms import parallelogram_form
from workbench.serial_tree import SerialTree

from .result import ActuatorIdentification, LegIdentification

_SURE = 2.0  # deviations by which something has to be impossible before it is called so
_ALPHA = np.radians(np.linspace(0.0, 180.0, 13))


def with_actuator(model: Model, *found: ActuatorIdentification) -> Model:
    """Return the model with every drive's inertia, damping and delay as identified (S3N-Act, Eqs. 12, 13).

    Args:
        model: the model.
        found: one drive that stands for all, or one per axis; the model has one delay, their mean.

    Raises:
        InputError: another number of drives.
    """
    n = model.size
    if len(found) not in (1, n):
        raise InputError(
            f"{len(found)} drives were identified and model '{model.name}' has {n}", file=model.source,
            remedy="identify one drive that stands for all, or every one",
        )  # fmt: skip
    each = found * n if len(found) == 1 else found
    return replace(
        model,
        actuators=replace(
            model.actuators,
            inertia=tuple(f.inertia.value for f in each),
            damping=tuple(f.damping.value for f in each),
            delay_s=max(sum(f.delay.value for f in each) / n, 0.0),
        ),
    )


def with_leg(model: Model, found: LegIdentification) -> Model:
    """Return the model as S3N-Full: actuators' share and serial tree subtracted once (Eqs. 15 and 19).

    Args:
        model: with its actuators and its serial tree.
        found: total inertia and gravity.

    Raises:
        InputError: the model is no parallelogram, or what is left for the links is no inertia that bodies
            can have.
    """
    if model.size != 2:
        raise InputError(
            f"model '{model.name}' has {model.size} axes", file=model.source,
            remedy="name a model of one leg with two drives",
        )  # fmt: skip
    links = found.total - np.array([model.actuators.inertia[0], 0.0, model.actuators.inertia[1]])
    check_physical(links, found.covariance, model)
    tree, gravity = serial_form(model)
    increment = links - tree
    weight = np.array([g.value for g in found.gravity]) - gravity
    crank = model.linkage.crank if model.linkage else None
    linkage = Linkage(*map(float, increment), *map(float, weight), identified=True, crank=crank)
    known = replace(model, linkage=linkage, variant="kin_only", effects=_others(model))
    return with_variant(known, "s3n_full")


def check_physical(links: np.ndarray, covariance: np.ndarray, model: Model) -> None:
    """Refuse link inertia that is not positive at every posture, by more than its uncertainty.

    Args:
        links: M11, M12, M22 of the links alone [kg m^2].
        covariance: of these, (3, 3).
        model: for the message.

    Raises:
        InputError: says which, and what it leaves for the links.
    """
    m11, m12, m22 = links
    deviation = np.sqrt(np.diag(covariance))
    for name, value, std, inertia in (
        ("M11", m11, deviation[0], model.actuators.inertia[0]),
        ("M22", m22, deviation[2], model.actuators.inertia[1]),
    ):
        if value <= -_SURE * std or value <= 0.0:
            raise InputError(
                f"the total {name} of {value + inertia:.5g} kg m^2 leaves {value:.4g} ± {_SURE * std:.2g} "
                f"for the links beside the actuator's {inertia:.5g}: no body has that", file=model.source,
                column="actuators.inertia", remedy="identify the actuator again, alone and at the same gear",
            )  # fmt: skip
    slope = np.array([m22, -2.0 * m12, m11])  # of the determinant at alpha = 0
    room = m11 * m22 - m12**2
    if room <= -_SURE * np.sqrt(max(slope @ covariance @ slope, 0.0)) or room <= 0.0:
        raise InputError(
            f"M12 = {m12:.4g} kg m^2 is more than links of M11 = {m11:.4g} and M22 = {m22:.4g} can couple",
            file=model.source, column="actuators.inertia",
            remedy="identify leg and actuators again; excite both modes at more postures",
        )  # fmt: skip


def serial_form(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """M11, M12 (factor of cos alpha), M22 [kg m^2] and g1, g2 [N m] of the serial tree, actuator coordinates.

    Raises:
        InputError: the tree is not of that form (angles not from straight down, or another mechanism).
    """
    tree, back = SerialTree(model), np.linalg.inv(model.transmission)
    q = np.stack([0.3 - 0.1 * _ALPHA, _ALPHA], axis=1)
    mass = back.T @ tree.link_mass_matrix(q)[:, :2, :2] @ back
    pull = tree.gravity(q)[:, :2] @ back
    inertia, g, off, _ = parallelogram_form(mass, pull, q, model.transmission)
    if off > 1e-6 * inertia[0]:
        raise InputError(
            f"the serial tree of '{model.name}' is not a thigh and shank whose angles are zero straight down",
            file=model.serial, remedy="align its zeros: both links hang along gravity at angle zero",
        )  # fmt: skip
    return inertia, g


def _others(model: Model) -> tuple[AppliedEffect, ...]:
    structural = {name for names in VARIANTS.values() for name in names}
    return tuple(e for e in model.effects if e.key.effect not in structural)
