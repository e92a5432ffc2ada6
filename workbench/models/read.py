"""Model files in and out: TOML for people, MJCF alone where no more is known."""

from __future__ import annotations

import contextlib
import re
import tomllib
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import tomli_w
from pydantic import ValidationError

from workbench.core import Controller, EffectKey, Estimate, InputError, Mechanism
from workbench.core.files import write_whole
from workbench.core.formats import check_format
from workbench.core.paths import models_folder
from workbench.core.text import plain

from .engine import warned
from .mjcf import check_mjcf
from .model import VARIANTS, Actuators, AppliedEffect, Linkage, Model
from .paths import find_model
from .schema import EffectTable, ModelTable, ParameterTable

_LINKAGE_KEYS = {"linkage_inertia": ("M11", "M12", "M22"), "linkage_gravity": ("g1", "g2")}
_LINKAGE_UNITS = {"M11": "kg*m^2", "M12": "kg*m^2", "M22": "kg*m^2", "g1": "N*m", "g2": "N*m"}


def read_model(path: str | Path) -> Model:
    """Read a model from a TOML file, or from an MJCF file with identity transmission and no drives.

    Args:
        path: a ``.toml`` or ``.xml`` file, or the name of a shipped model.

    Raises:
        InputError: anything wrong with the file; one line with the key and the remedy.
    """
    file = find_model(path)
    if file.suffix == ".xml":
        return _from_table(ModelTable(format=1, name=file.stem, serial=file.name), file)
    try:
        raw = tomllib.loads(file.read_text(encoding="utf-8-sig"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"not a TOML file: {error}", file=file, remedy="correct the syntax") from error
    check_format(raw, 1, file)
    try:
        table = ModelTable.model_validate(raw)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise InputError(first["msg"], file=file, column=key, remedy="see docs/models.md") from error
    return _from_table(table, file)


def load_mjcf(path: Path) -> mujoco.MjSpec:
    """Parse an MJCF file.

    Raises:
        InputError: MuJoCo cannot read it; its own reason is kept. Or it has plugins, or names files that do
            not lie beside or below it.
    """
    check_mjcf(path)
    try:
        return mujoco.MjSpec.from_file(str(path))
    except (ValueError, mujoco.FatalError) as error:
        raise InputError(
            f"MuJoCo cannot read this MJCF: {error}", file=path, remedy="correct what it names"
        ) from error


def _resolve(file: Path, name: str, key: str) -> Path:
    for folder in (file.parent, models_folder()):
        with contextlib.suppress(OSError):  # a name longer than the system allows
            if (folder / name).is_file():
                return (folder / name).resolve()
    raise InputError(
        f"'{name}' does not exist", file=file, column=key, remedy="give a path relative to this file"
    )


def _hinges_and_slides(spec: mujoco.MjSpec, file: Path) -> list[str]:
    names: list[str] = []
    for joint in spec.joints:
        if joint.type not in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
            raise InputError(
                f"joint '{joint.name}' is free or a ball",
                file=file,
                remedy="a model has hinge and slide joints only: fix the base",
            )
        if not joint.name:
            raise InputError("a joint has no name", file=file, remedy="name every joint")
        names.append(joint.name)
    if not names:
        raise InputError("the MJCF has no joints", file=file, remedy="give a tree with hinge or slide joints")
    try:
        with warned():  # what is lacking may stand in the model file, as a drive's inertia does
            spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        raise InputError(
            f"MuJoCo cannot compile this MJCF: {error}", file=file, remedy="correct what it names"
        ) from error
    return names


def _per_axis(value: list[float] | float, n: int, file: Path, key: str) -> tuple[float, ...]:
    values = [value] * n if isinstance(value, (int, float)) else value
    if len(values) != n:
        raise InputError(
            f"{len(values)} values for {n} axes", file=file, column=key, remedy="give one an axis"
        )
    return tuple(float(v) for v in values)


def _from_table(table: ModelTable, file: Path) -> Model:
    serial = _resolve(file, table.serial, "serial")
    spec = load_mjcf(serial)
    known = _hinges_and_slides(spec, serial)
    joints = table.transmission.joints if table.transmission else (table.axes or known)
    axes = table.axes or joints
    n = len(axes)
    for joint in joints:
        if joint not in known:
            raise InputError(
                f"the MJCF has no joint '{joint}'", file=file, column="transmission.joints",
                remedy=f"joints are {', '.join(known)}",
            )  # fmt: skip
    if len(set(axes)) != n or len(set(joints)) != len(joints):
        raise InputError("a name stands twice", file=file, column="axes", remedy="name each axis once")
    given = table.transmission.matrix if table.transmission else None
    rows = np.eye(n).tolist() if given is None else given
    if n == 0 or len(joints) != n or len(rows) != n or any(len(row) != n for row in rows):
        raise InputError(
            f"{n} axes, {len(joints)} joints and matrix rows of {[len(row) for row in rows]} numbers",
            file=file, column="transmission",
            remedy="the matrix must be square, one row an axis and one column a joint",
        )  # fmt: skip
    matrix = np.array(rows, float)
    if not np.linalg.cond(matrix) < 1e9:
        raise InputError(
            "the transmission matrix is singular", file=file, column="transmission.matrix",
            remedy="its rows must be independent: each drive moves what no mixture of the others does",
        )  # fmt: skip
    if table.payload and all(site.name != table.payload.site for site in spec.sites):
        raise InputError(
            f"the MJCF has no site '{table.payload.site}'", file=file, column="payload.site",
            remedy=f"sites are {', '.join(s.name for s in spec.sites if s.name) or 'none: add one'}",
        )  # fmt: skip
    linkage = Linkage(**table.linkage.model_dump()) if table.linkage else None
    structural = VARIANTS[table.variant]
    if linkage is None and set(structural) & set(_LINKAGE_KEYS):
        raise InputError(
            f"variant '{table.variant}' needs a [linkage] table", file=file, column="variant",
            remedy="give its identified parameters",
        )  # fmt: skip
    a = table.actuators
    return Model(
        name=table.name,
        serial=serial,
        axes=tuple(axes),
        joints=tuple(joints),
        transmission=matrix,
        actuators=Actuators(
            _per_axis(a.inertia, n, file, "actuators.inertia"),
            _per_axis(a.damping, n, file, "actuators.damping"),
            _per_axis(a.torque_limit, n, file, "actuators.torque_limit"),
            a.delay_s,
            a.full_braking,
        ),
        closed_chain=_mechanism(table, n, file),
        posture_dependent=bool(table.transmission and table.transmission.posture_dependent),
        linkage=linkage,
        variant=table.variant,
        effects=(
            *(structural_effect(name, linkage) for name in structural),
            *(_effect(entry, axes, file) for entry in table.effects),
        ),
        controller=_controller(table, n, file),
        payload_site=table.payload.site if table.payload else None,
        sliding_speed=table.friction.sliding_speed,
        source=file,
    )


def _mechanism(table: ModelTable, n: int, file: Path) -> Mechanism | None:
    chain = table.closed_chain
    if chain is None:
        return None
    if isinstance(chain, str):
        return Mechanism(_resolve(file, chain, "closed_chain"))
    for key, count in (("drives", len(chain.drives)), ("joints", len(chain.joints))):
        if count != n:
            raise InputError(
                f"{count} names for {n} axes", file=file, column=f"closed_chain.{key}",
                remedy="name one joint of the closed chain an axis",
            )  # fmt: skip
    if chain.limits and (len(chain.limits) != n or any(low >= high for low, high in chain.limits)):
        raise InputError(
            f"limits are not {n} pairs of a lower and a higher number", file=file,
            column="closed_chain.limits", remedy="give one pair a serial joint",
        )  # fmt: skip
    return Mechanism(
        _resolve(file, chain.file, "closed_chain.file"),
        tuple(chain.drives),
        tuple(chain.joints),
        tuple(chain.loops),
        chain.foot,
        tuple(chain.start.items()),
        tuple(chain.limits),
    )


def structural_effect(name: str, linkage: Linkage | None) -> AppliedEffect:
    """A structural effect of S3N with the parameters that identification gave."""
    keys = _LINKAGE_KEYS.get(name, ())
    values = {k: Estimate(getattr(linkage or Linkage(), k), 0.0, _LINKAGE_UNITS[k]) for k in keys}
    return AppliedEffect(EffectKey(name, None), values)


def _effect(entry: EffectTable, axes: list[str], file: Path) -> AppliedEffect:
    if entry.axis is not None and entry.axis not in axes:
        raise InputError(
            f"effect '{entry.effect}' is on axis '{entry.axis}'", file=file, column="effects.axis",
            remedy=f"axes are {', '.join(axes)}",
        )  # fmt: skip
    values = {
        name: Estimate(p.value, p.std, p.unit)
        if isinstance(p, ParameterTable)
        else Estimate(float(p), 0.0, "")
        for name, p in entry.parameters.items()
    }
    return AppliedEffect(EffectKey(entry.effect, entry.axis, entry.location), values)


def _controller(table: ModelTable, n: int, file: Path) -> Controller:
    c = table.controller
    if c is None:
        return Controller()
    per_axis = {
        key: _per_axis(getattr(c, key), n, file, f"controller.{key}")
        for key in ("kp", "kd", "kv", "gain", "limit")
        if getattr(c, key) != []
    }
    needed = {"pd": ("kp", "kd"), "cascade_pv": ("kp", "kv", "gain")}.get(c.kind, ())
    for key in needed:
        if key not in per_axis:
            raise InputError(
                f"controller of kind '{c.kind}' has no {key}", file=file, column=f"controller.{key}",
                remedy=f"give {', '.join(needed)}, one value an axis",
            )  # fmt: skip
    return Controller(kind=c.kind, coordinates=c.coordinates, period_s=c.period_s, **per_axis)


def write_model(model: Model, path: str | Path, *, force: bool = False) -> None:
    """Write a model as TOML, whole or not at all; it reads back equal.

    Raises:
        InputError: the file exists and `force` is not set, or cannot be written.
    """
    write_whole(path, model_text(model, path), force=force)


def model_text(model: Model, path: str | Path) -> str:
    """The text of a model file that is to lie at `path`."""
    text = tomli_w.dumps(model_table(model, Path(path).resolve().parent))
    name = " ".join(plain(model.name).split())  # a comment ends with its line
    return f"# {name}: written by workbench.\n" + _arrays_on_one_line(text)


def _arrays_on_one_line(text: str) -> str:
    """Innermost arrays as a person would write them; nothing else changes."""
    return re.sub(
        r"\[\n([^\[\]{}]*?),?\n\s*\]",
        lambda m: "[" + ", ".join(x.strip() for x in m[1].split(",\n")) + "]",
        text,
    )


def model_table(model: Model, folder: Path) -> dict[str, Any]:
    """The model as the nested tables of a model file that lies in `folder`."""
    # a structural effect that was taken out or given other values makes it no longer that variant
    inside = tuple(structural_effect(name, model.linkage) for name in VARIANTS[model.variant])
    variant = model.variant if model.effects[: len(inside)] == inside else "kin_only"
    skip = len(VARIANTS[variant])
    table: dict[str, Any] = {
        "format": 1,
        "name": model.name,
        "serial": _relative(model.serial, folder),
        "variant": variant,
        "axes": list(model.axes),
        "transmission": {
            "joints": list(model.joints),
            "matrix": model.transmission.tolist(),
            **({"posture_dependent": True} if model.posture_dependent else {}),
        },
        "actuators": {
            "inertia": list(model.actuators.inertia),
            "damping": list(model.actuators.damping),
            "delay_s": model.actuators.delay_s,
            **({"full_braking": True} if model.actuators.full_braking else {}),
        },
    }
    if any(np.isfinite(model.actuators.torque_limit)):
        table["actuators"]["torque_limit"] = list(model.actuators.torque_limit)
    if model.closed_chain:
        table["closed_chain"] = _closed_chain_table(model.closed_chain, folder)
    if model.controller.kind != "unknown":
        c = model.controller
        entries = {k: list(getattr(c, k)) for k in ("kp", "kd", "kv", "gain", "limit") if getattr(c, k)}
        table["controller"] = {"kind": c.kind, "coordinates": c.coordinates, **entries}
        if c.period_s:
            table["controller"]["period_s"] = c.period_s
    if model.linkage:
        table["linkage"] = dict(vars(model.linkage))
    if model.payload_site:
        table["payload"] = {"site": model.payload_site}
    table["friction"] = {"sliding_speed": model.sliding_speed}
    table["effects"] = [_effect_table(e) for e in model.effects[skip:]]
    if not table["effects"]:
        del table["effects"]
    return table


def _closed_chain_table(chain: Mechanism, folder: Path) -> dict[str, Any]:
    table: dict[str, Any] = {
        "file": _relative(chain.file, folder),
        "drives": list(chain.drives),
        "joints": list(chain.joints),
        "loops": [list(pair) for pair in chain.loops],
    }
    if chain.foot:
        table["foot"] = chain.foot
    if chain.start:
        table["start"] = dict(chain.start)
    if chain.limits:
        table["limits"] = [list(pair) for pair in chain.limits]
    return table


def _effect_table(effect: AppliedEffect) -> dict[str, Any]:
    entry: dict[str, Any] = {"effect": effect.key.effect}
    if effect.key.axis:
        entry["axis"] = effect.key.axis
    entry["location"] = effect.key.location
    entry["parameters"] = {k: dict(vars(v)) for k, v in effect.parameters.items()}
    return entry


def _relative(path: Path, folder: Path) -> str:
    """A path that is found again: in the shipped models, beside the new file, or absolute."""
    for root in (models_folder().resolve(), folder):
        # one of the same name beside the new file would be found first
        if path.is_relative_to(root) and (root == folder or not (folder / path.relative_to(root)).exists()):
            return path.relative_to(root).as_posix()
    return path.as_posix()
