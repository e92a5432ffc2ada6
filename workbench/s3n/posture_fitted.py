"""A posture-dependent mechanism as plain MJCF for any training pipeline; the file states its errors."""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from workbench.core import InputError, SimulationError
from workbench.effects import Build, build, effect_named, rigid_in_steps
from workbench.models import AppliedEffect, Model, Placement, axis_tendon, load_mjcf

from .additions import additions
from .drives import add_motors
from .mjcf import anchor_assets, exact_xml
from .normalise import NormalisedTree, outside
from .on_drives import on_drives
from .posture import PostureDependent
from .posture_error import PostureError, posture_error
from .posture_mjcf import write_fit
from .posture_native import fit
from .worlds import INTEGRATORS

#: Largest relative error of the inertia that a file may have unless more is allowed.
ALLOWED = 0.05


@dataclass(frozen=True)
class FittedTree(NormalisedTree):
    """A fitted model as plain MJCF.

    Attributes:
        error: what it is off by over the workspace.
        offsets: what to take from the length of each motor's transmission to have the drive's position (n,).
    """

    error: PostureError
    offsets: np.ndarray


def fit_native(
    model: Model, *, allow: float | None = ALLOWED, branches: int = 8, chain: PostureDependent | None = None
) -> FittedTree:
    """Return a model's serial tree fitted to its closed chain; takes some seconds.

    The fit chooses new inertials for the links. Each drive is a tendon in space: its length is the drive's
    position, and it carries rotor, damping and motor. Springs stand for the weight that a drive carries,
    which is right while the base is level. If the transmission changes with the posture, the file contains
    these effects: rotor, damping, dry friction and motor properties of the drives, and added mass of links.

    Args:
        model: with a closed chain and its limits.
        allow: largest relative error of the inertia; None for any.
        branches: distances that add up to a drive's position, at most; more are nearer and cost more a step.
        chain: the mechanism, if it is at hand.

    Raises:
        InputError: no closed chain or limits, or a fit that is worse than allowed.
        SimulationError: MuJoCo cannot have it as plain MJCF; says why.
    """
    if branches < 1:
        raise InputError(f"{branches} branches", remedy="give one or more")
    chain = chain or PostureDependent(model)
    found = fit(chain, branches)
    spec = load_mjcf(model.serial)
    if not model.friction_as_in_mjcf:
        for dry in (e for e in (*spec.joints, *spec.tendons) if e.frictionloss):
            dry.solref_friction, dry.solimp_friction = rigid_in_steps(spec.option.timestep)
    removed = [f"actuator {a.name or a.id}: drives are the model's" for a in spec.actuators]
    for sensor in [s for s in spec.sensors if s.objtype == mujoco.mjtObj.mjOBJ_ACTUATOR]:
        removed.append(f"sensor {sensor.name or sensor.id}: its actuator is gone")
        spec.delete(sensor)
    for actuator in list(spec.actuators):
        spec.delete(actuator)
    spec.option.integrator = INTEGRATORS["implicitfast"]
    tendons = write_fit(found, spec)
    there = on_drives(model)
    own = there.carried is not None
    at_drives = build(there, spec.option.timestep) if own else Build.of(model)
    add_motors(replace(Build.of(model), spec=spec, chain=at_drives.chain), model, tendons)
    anchor_assets(spec, model.serial)
    spec.modelname = model.name
    try:
        error = posture_error(chain, spec.compile(), found.offsets)
        for i, (tendon, row) in enumerate(zip(tendons, found.rows, strict=True) if own else ()):
            _put_effects(at_drives, i, spec, tendon, model, row)
        added = additions(load_mjcf(model.serial).compile(), spec.compile())
        spec.comment = _header(model, error, found.offsets)
        spec.compile()
        xml = exact_xml(spec)
        compiled = mujoco.MjModel.from_xml_string(xml)
    except ValueError as problem:
        raise SimulationError(f"model '{model.name}' cannot be written as plain MJCF: {problem}") from problem
    if allow is not None and not error.inertia_max <= allow:
        raise InputError(
            f"as plain MJCF the inertia of '{model.name}' is off by up to {error.inertia_max:.1%} (at "
            f"{error.inertia_at}), and {allow:.1%} are allowed", file=model.source,
            remedy="allow more (--allow-error) or narrow the limits",
        )  # fmt: skip
    return FittedTree(model, xml, compiled, added, left_out(model), tuple(removed), error, found.offsets)


def left_out(model: Model) -> tuple[str, ...]:
    """Return the effects of a model that its fit does not contain."""
    there = on_drives(model)
    return tuple(
        str(e.key)
        for e in model.effects
        if there.carried is None or outside(there, e) or _is_spring(there, e)
    )


def _put_effects(
    at_drives: Build, drive: int, spec: mujoco.MjSpec, tendon: str, model: Model, row: np.ndarray
) -> None:
    """Write the effects of one drive onto its tendon in the file, or onto the joint that it drives."""
    own, rotor = at_drives.spec.tendon(axis_tendon(drive)), at_drives.spec.joint(model.axes[drive])
    joint = int(np.abs(row).argmax())
    there = spec.tendon(tendon) if tendon else spec.joint(model.joints[joint])
    ratio = 1.0 if tendon else abs(float(row[joint]))
    # less than a rotor has stands on the joint, where a tendon has nothing to give
    more = own.armature + rotor.armature - model.actuators.inertia[drive]
    there.armature = max(there.armature + ratio**2 * more, 0.0)
    there.damping[0] += ratio**2 * own.damping[0]
    there.frictionloss += ratio * own.frictionloss
    if own.frictionloss:
        there.solref_friction, there.solimp_friction = rigid_in_steps(spec.option.timestep)


def _is_spring(there: Model, applied: AppliedEffect) -> bool:
    """Return whether an effect is a drive's stiffness; its tendon already has springs for the weight."""
    alone = Build.of(there)
    effect_named(applied.key.effect).install(alone, there, Placement.of(there, applied.key), applied.values)
    return any(np.any(t.stiffness) for t in alone.spec.tendons)


def error_lines(error: PostureError) -> list[str]:
    """Return the errors of a fit in words."""
    lines = [
        f"inertia by up to {error.inertia_max:.2%} (at {error.inertia_at}), {error.inertia_rms:.2%} rms",
        f"gravity by up to {error.gravity_max:.3g} N m, {error.gravity_rms:.2%} rms",
        f"velocity terms by {error.velocity_rms:.1%} rms",
    ]
    if error.torque_max is not None and error.position_max is not None:
        lines.append(f"torque of a drive by up to {error.torque_max:.2%}")
        lines.append(f"position of a drive by up to {error.position_max:.2g} rad")
    return lines


def _header(model: Model, error: PostureError, offsets: np.ndarray) -> str:
    """Return the comment at the top of the file."""
    shifts = ", ".join(f"{axis} {x:.9g}" for axis, x in zip(model.axes, offsets, strict=True))
    lines = [
        f" {model.name}, a mechanism whose transmission depends on the posture, fitted over its limits:",
        " written by workbench.",
        " Largest and typical differences from the closed chain over the workspace:",
        *(f"   {line}" for line in error_lines(error)),
        "",
        " A drive is a tendon in space. Its position is its motor's length minus these, in rad:",
        f"   {shifts}",
        " Springs carry the weight that acts on the drives; this is right while the base is level.",
    ]
    return "\n".join(lines).replace("--", "- -") + "\n"
