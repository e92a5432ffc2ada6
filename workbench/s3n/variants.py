"""The variants of S3N: which of them a plain MJCF holds, and a model turned into each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.core import InputError
from workbench.effects.structure import is_parallelogram
from workbench.models import VARIANTS, Linkage, Model, structural_effect

#: Variants that no plain MJCF holds, or that are another mechanism; each with the plain one it starts from.
PER_STEP = {
    "s3n_full_paper": "s3n_full",  # the paper's equation to the letter: no velocity terms of the linkage
    "explicit": "kin_only",  # the paper's implementation: torques from the preceding step's acceleration
    "constraint": "exact",  # the loop closed by equality constraints
}
VARIANT_NAMES = (*VARIANTS, *PER_STEP)
_STRUCTURAL = tuple(dict.fromkeys(name for names in VARIANTS.values() for name in names))


def with_variant(model: Model, variant: str) -> Model:
    """Return the model as one of the plain variants; effects that are not structural stay.

    A structural effect that the model has keeps its own parameters; one that it lacks gets the linkage's.

    Raises:
        InputError: no such variant, or one that needs a linkage the model does not state.
    """
    if variant not in VARIANTS:
        raise InputError(
            f"no plain variant is called '{variant}'", file=model.source,
            remedy=f"choose one of {', '.join(VARIANTS)}",
        )  # fmt: skip
    wanted = VARIANTS[variant]
    if any(name.startswith("linkage") for name in wanted):
        need_parallelogram(model, variant)
    inside = tuple(
        effect
        for name in wanted
        for effect in (
            tuple(e for e in model.effects if e.key.effect == name)
            or (structural_effect(name, model.linkage),)
        )
    )
    others = tuple(e for e in model.effects if e.key.effect not in _STRUCTURAL)
    return replace(model, variant=variant, effects=(*inside, *others))


def usual_variant(model: Model) -> str:
    """Return the variant that plain MJCF is written as by default: all stated physics a tree can hold.

    The linkage's inertia where it is known, at least the drives' where one moves several joints; a model that
    states more than Kin-Only keeps its own variant.
    """
    if model.variant != "kin_only":
        return model.variant
    if is_parallelogram(model):
        return "s3n_full"
    coupled = not np.array_equal(model.transmission, np.eye(model.size))
    heavy = any(model.actuators.inertia) or any(model.actuators.damping)
    return "s3n_act" if coupled and heavy else "kin_only"


def omissions(model: Model) -> tuple[str, ...]:
    """Return what a model's variant leaves out of the stated mechanism, each with its size."""
    linkage, out = model.linkage, []
    coupled = not np.array_equal(model.transmission, np.eye(model.size))
    if coupled and any(model.actuators.inertia) and not model.has("actuator_inertia_coupling"):
        out.append("the coupling of the joints by the drives' inertia, which sits on each drive's own joint")
    if linkage is not None and not model.has("linkage_inertia"):
        sizes = ", ".join(f"{k} = {getattr(linkage, k):.4g}" for k in ("M11", "M12", "M22"))
        out.append(f"the linkage's inertia ({sizes} kg m²)")
    if linkage is not None and not model.has("linkage_gravity"):
        out.append(f"the linkage's weight (g1 = {linkage.g1:.4g}, g2 = {linkage.g2:.4g} N m)")
    return tuple(out)


def need_parallelogram(model: Model, what: str) -> Linkage:
    """Return the model's linkage; raise if it has none.

    Raises:
        InputError: it states none, or its transmission is not the parallelogram's.
    """
    if model.linkage is None or not is_parallelogram(model):
        raise InputError(
            f"'{what}' needs a parallelogram with a [linkage] table", file=model.source,
            remedy="give its increments and the transmission [[1, 0], [1, 1]]",
        )  # fmt: skip
    return model.linkage


def need_constant_transmission(model: Model, what: str) -> None:
    """Raise if the model's J changes with the posture.

    Raises:
        InputError: its transmission is that of one posture only.
    """
    if model.posture_dependent:
        raise InputError(
            f"{what} needs a transmission that does not change with the posture", file=model.source,
            column="transmission.posture_dependent",
            remedy="plain MJCF has fixed coefficients only: run the variant 'constraint'",
        )  # fmt: skip


def linkage_inertia(model: Model) -> Linkage:
    """Return the increments M11, M12, M22 of the model's linkage over its serial tree.

    The sum of its ``linkage_inertia`` effects where it has any, else what its linkage states.

    Raises:
        InputError: it has no parallelogram.
    """
    stated = need_parallelogram(model, "linkage_inertia")
    own = [e.values for e in model.effects if e.key.effect == "linkage_inertia"]
    if not own:
        return stated
    return replace(stated, **{k: sum(v[k] for v in own) for k in ("M11", "M12", "M22")})
