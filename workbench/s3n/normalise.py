"""The S3N-normalised serial tree as plain MJCF, for anybody's training pipeline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from workbench.core import SimulationError
from workbench.effects import (
    BASE_JOINT,
    Build,
    TorqueChain,
    build,
    compile_plant,
    effect_named,
    settle_contacts,
)
from workbench.models import NO_FRICTION, AppliedEffect, Model, Placement, load_mjcf

from .additions import Addition, additions
from .drives import MOTOR_STAGES, add_motors, settle_axes
from .dynamics import compiled_dynamics
from .merge import merge_into_links
from .mjcf import anchor_assets, exact_xml, write_with_assets
from .variants import need_constant_transmission, with_variant
from .worlds import INTEGRATORS

_SAME = 1e-11  # relative difference from the model that is nothing but rounding
_FEATHER = 2e-9  # kg: what bodies that are nothing but weight have, which only a base that moves can feel
_KEY = "time", "qpos", "qvel", "mpos", "mquat"
_SENSOR = (
    *("type", "objtype", "objname", "reftype", "refname", "intprm", "datatype", "needstage", "dim"),
    *("cutoff", "noise", "userdata", "nsample", "interp", "delay", "interval"),
)


@dataclass(frozen=True)
class NormalisedTree:
    """A model as plain MJCF.

    Attributes:
        model: what it was made from.
        xml: the file's text.
        mujoco: the text, compiled.
        added: what differs from the user's own MJCF, and by how much.
        left_out: effects of the model, and properties, that need a torque function or act on sensors and
            loop, and are not in the file.
        removed: elements of the user's MJCF that are not in the file, each with its reason.
    """

    model: Model
    xml: str
    mujoco: mujoco.MjModel
    added: tuple[Addition, ...]
    left_out: tuple[str, ...]
    removed: tuple[str, ...]


def normalise(
    model: Model, variant: str | None = None, integrator: str | None = "implicitfast"
) -> NormalisedTree:
    """Return a model's serial tree with its physics written into it, so that plain MuJoCo simulates it.

    Inertia, damping, springs and dry friction of a drive that moves one joint are that joint's; of one that
    moves several, a fixed tendon's. The linkage's inertia is part of the links' own. Every drive has a motor
    with the model's torque limit, delay, gain and bias. The user's bodies, geoms, sites and meshes stay.

    Args:
        model: the model, with its effects.
        variant: a plain variant of S3N in place of the model's own.
        integrator: of the file; None keeps the user's. ``Euler`` integrates a tendon's damping explicitly.

    Raises:
        InputError: no such variant, a base that floats, or a transmission that changes with the posture.
        SimulationError: MuJoCo cannot have the model as plain MJCF; says why.
    """
    need_constant_transmission(model.on_its_stand("S3N"), "a plain MJCF file")
    model = model if variant is None else with_variant(model, variant)
    own = load_mjcf(model.serial)
    elastic = replace(model, flank_retardation_s=0.0)
    made, plant = build(elastic, own.option.timestep), compile_plant(elastic, own.option.timestep)
    spec, before = made.spec, own.compile()
    spec.compile()
    merge_into_links(spec, own, plant.mujoco)
    settle_contacts(made)
    for name in ("timestep", "iterations", "tolerance", "disableflags", "integrator"):
        setattr(spec.option, name, getattr(own.option, name))
    spec.option.disableflags &= ~NO_FRICTION  # switched off is only what the file itself had of it
    if integrator is not None:
        spec.option.integrator = INTEGRATORS[integrator]
    add_motors(made, model, settle_axes(made, plant))
    removed = _keep(spec, own)
    anchor_assets(spec, model.serial)
    left_out = tuple(str(e.key) for e in elastic.effects if outside(elastic, e))
    if model.flank_retardation_s and any(e.key.effect == "backlash" for e in model.effects):
        left_out = (*left_out, "damping of flanks")
    spec.modelname = model.name
    try:
        added = additions(before, spec.compile())
        spec.comment = _header(model, added, left_out, plant.substeps)
        spec.compile()
        xml = exact_xml(spec)
        compiled = mujoco.MjModel.from_xml_string(xml)
    except ValueError as error:
        raise SimulationError(f"model '{model.name}' cannot be written as plain MJCF: {error}") from error
    _verify(model, plant.mujoco, compiled)
    return NormalisedTree(model, xml, compiled, added, left_out, removed)


def write_normalised(tree: NormalisedTree, path: str | Path, *, force: bool = False) -> Path:
    """Write the MJCF file whole or not at all, and return its path; meshes, textures relative to it.

    Those that do not lie beside or below it are copied to where it lies.

    Raises:
        InputError: the file exists and `force` is not set, or it cannot be written.
    """
    return write_with_assets(tree.xml, path, force=force)[0]


def outside(model: Model, applied: AppliedEffect) -> bool:
    """Return whether an effect changes a stage of the torque chain that MuJoCo's motors do not have."""
    alone = Build.of(model)
    effect_named(applied.key.effect).install(alone, model, Placement.of(model, applied.key), applied.values)
    neutral = vars(TorqueChain.of(model))
    stages = {name: value for name, value in vars(alone.chain).items() if name not in MOTOR_STAGES}
    return not all(_same(value, neutral[name]) for name, value in stages.items())


def _same(one: Any, other: Any) -> bool:
    if hasattr(one, "__dict__") and not isinstance(one, np.ndarray):
        return all(_same(value, vars(other)[name]) for name, value in vars(one).items())
    return bool(np.array_equal(one, other))


def _keep(spec: mujoco.MjSpec, own: mujoco.MjSpec) -> tuple[str, ...]:
    """Copy the user's sensors and keyframes into the built spec; return what could not be kept."""
    removed = [f"actuator {a.name or a.id}: drives are the model's" for a in own.actuators]
    for sensor in own.sensors:
        if sensor.objtype == mujoco.mjtObj.mjOBJ_ACTUATOR:
            removed.append(f"sensor {sensor.name or sensor.id}: its actuator is gone")
            continue
        _copy(sensor, spec.add_sensor(name=sensor.name), _SENSOR)
    same = len(list(spec.joints)) == len(list(own.joints))
    for key in own.keys:
        if not same:
            removed.append(f"keyframe {key.name or key.id}: the model has other joints")
            continue
        _copy(key, spec.add_key(name=key.name), _KEY)
    return tuple(removed)


def _copy(source: Any, target: Any, names: Sequence[str]) -> None:
    for name in names:
        setattr(target, name, getattr(source, name))


def _header(model: Model, added: tuple[Addition, ...], left_out: tuple[str, ...], substeps: int) -> str:
    """Return the comment at the top of the file."""
    lines = [f" {model.name}, S3N-normalised (variant {model.variant}): written by workbench.", ""]
    lines += [f"   {entry}" for entry in added]
    if left_out:
        lines += [
            "",
            " Not in this file, because plain MJCF cannot state it: each needs a function at every step.",
        ]
        lines += [f"   {name}" for name in left_out]
    if substeps > 1:
        lines += ["", f" Its springs oscillate fast: use steps of at most 1/{substeps} of this timestep."]
    if model.actuators.delay_s:
        lines += ["", " The motors' delay is exact for timesteps down to half of this one."]
    return "\n".join(lines).replace("--", "- -") + "\n"


def _verify(model: Model, plant: mujoco.MjModel, compiled: mujoco.MjModel) -> None:
    """Raise if mass matrix, velocity terms, gravity or damping of the file differ from the model's.

    Raises:
        SimulationError: they differ by more than rounding.
    """
    generator = np.random.default_rng(5)
    new = {plant.joint(i).name for i in range(plant.njnt)} - {j.name for j in load_mjcf(model.serial).joints}
    joints = (*model.joints, *sorted(new))
    q, v = (generator.uniform(-1.5, 1.5, (5, len(joints))) for _ in range(2))
    one, other = (compiled_dynamics(m, joints, q, v) for m in (plant, compiled))
    slack = _FEATHER if BASE_JOINT in new else 0.0
    for name, wanted in vars(one).items():
        with np.errstate(invalid="ignore"):
            worst = float(np.abs(getattr(other, name) - wanted).max())
        # what is no number differs
        if not worst <= _SAME * max(float(np.abs(wanted).max()), 1e-3) + slack:
            raise SimulationError(
                f"model '{model.name}' as plain MJCF has another {name}: it differs by {worst:.1e}"
            )
