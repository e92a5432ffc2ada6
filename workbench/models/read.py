"""Model files as they are read: TOML for people, MJCF alone where no more is known."""

from __future__ import annotations

import contextlib
import tomllib
from pathlib import Path

import mujoco
import numpy as np
from pydantic import ValidationError

from workbench.core import Controller, EffectKey, Estimate, InputError, Mechanism
from workbench.core.formats import check_format
from workbench.core.paths import models_folder
from workbench.core.unfinished import finish

from .engine import warned
from .mjcf import check_mjcf
from .model import VARIANTS, Actuators, AppliedEffect, Ground, Linkage, Model
from .paths import find_model
from .schema import EffectTable, GroundTable, ModelTable, ParameterTable

_STRONGEST = 1e6  # m/s^2; no machine stands where gravity is stronger
_LINKAGE_KEYS = {"linkage_inertia": ("M11", "M12", "M22"), "linkage_gravity": ("g1", "g2")}
_LINKAGE_UNITS = {"M11": "kg*m^2", "M12": "kg*m^2", "M22": "kg*m^2", "g1": "N*m", "g2": "N*m"}


def read_model(path: str | Path) -> Model:
    """Read a model from a TOML file, or from an MJCF file with identity transmission and no drives.

    Args:
        path: a ``.toml`` or ``.xml`` file, or the name of a shipped model.

    Raises:
        InputError: anything wrong with the file; one line with the key and the remedy.
    """
    finish(Path(path).parent)
    file = find_model(path)
    if file.suffix == ".xml":
        return _from_table(ModelTable(format=1, name=file.stem, serial=file.name), file)
    try:
        raw = tomllib.loads(file.read_text(encoding="utf-8-sig"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"not a TOML file: {error}", file=file, remedy="correct the syntax") from error
    check_format(raw, 1, file)
    if "table" in raw and "serial" not in raw:
        raise InputError(
            "is a recording, not a model", file=file, remedy="the model comes first: MODEL REC..."
        )
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
    strongest = float(max(spec.option.gravity, key=abs))
    if not abs(strongest) < _STRONGEST:
        problem = f"gravity is {strongest:.3g} m/s^2"
        raise InputError(problem, file=file, column="gravity", remedy="give it in m/s^2")
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
        payload_site=table.payload.site if table.payload else _end(spec),
        sliding_speed=table.friction.sliding_speed,
        ground=_ground(table.ground, spec, file),
        source=file,
    )


def _end(spec: mujoco.MjSpec) -> str | None:
    """The site where the machine ends and a payload would hang, if only one is at the end of what moves."""
    moving = [b for b in spec.bodies if b.joints]
    ends = [b for b in moving if not any(other is not b and _carries(b, other) for other in moving)]
    sites = [s.name for b in ends for s in b.find_all("site") if s.name]
    return sites[0] if len(sites) == 1 else None


def _carries(body: mujoco.MjsBody, other: mujoco.MjsBody) -> bool:
    return any(below.name == other.name for below in body.find_all("body"))


def _ground(table: GroundTable | None, spec: mujoco.MjSpec, file: Path) -> Ground | None:
    if table is None:
        return None

    def refuse(problem: str, key: str, remedy: str) -> InputError:
        return InputError(problem, file=file, column=f"ground.{key}", remedy=remedy)

    sites, geoms = ({e.name for e in kind if e.name} for kind in (spec.sites, spec.geoms))
    for name in table.feet:
        if name not in sites | geoms:
            known = ", ".join(sorted(sites | geoms)) or "none: add one"
            raise refuse(f"the MJCF has no site or geom '{name}'", "feet", f"sites and geoms are {known}")
        if name in sites and table.radius is None:
            raise refuse(f"the foot at site '{name}' has no size", "radius", "give its radius [m]")
    if (table.height is None) == (table.surface is None):
        raise refuse("states height and surface, or neither", "height", "give one of the two")
    if table.surface is not None and table.surface not in {g.name for g in spec.worldbody.geoms}:
        raise refuse(f"the MJCF's world has no geom '{table.surface}'", "surface", "name one of its geoms")
    if (table.stiffness is None) != (table.damping is None):
        raise refuse("stiffness and damping go together", "stiffness", "give both, or leave both out")
    return Ground(**{**table.model_dump(), "feet": tuple(table.feet)})


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
