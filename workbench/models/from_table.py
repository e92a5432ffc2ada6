"""A model from the table of a model file, with each part checked against the MJCF and the number of axes."""

from __future__ import annotations

import contextlib
from pathlib import Path

import mujoco
import numpy as np

from workbench.core import Controller, Coupling, InputError, Mechanism
from workbench.core.paths import models_folder

from .floating import BASE_AXES
from .model import Actuators, Crank, Ground, Linkage, Model
from .schema import ActuatorTable, GroundTable, LinkageTable, ModelTable
from .shared_drives import shared_drives
from .spec import end_site, hinges_and_slides, load_tree
from .stated_effects import effects_of_entry, effects_of_variant

_SINGULAR = 1e9  # condition of a transmission that no drives have


def from_table(table: ModelTable, file: Path) -> Model:
    """Return the model that a table states.

    Args:
        table: as it was read.
        file: it was read from, or the MJCF itself: paths in it are relative to that.

    Raises:
        InputError: anything wrong with it, or with the MJCF that it names.
    """
    serial = _resolve(file, table.serial, "serial")
    spec = load_tree(serial)
    known = hinges_and_slides(spec, serial)
    base = BASE_AXES if set(BASE_AXES) <= set(known) else ()  # many an arm turns about its "base_yaw"
    own = [name for name in known if name not in base]
    drives = shared_drives(spec, own, serial) if table.transmission is None else None
    axes, joints, matrix = _transmission(table, own, file)
    if drives is not None:
        axes, matrix = tuple(table.axes or drives[0]), drives[1]
    n = len(axes)
    payload_site = _payload_site(table, spec, file)
    linkage = _linkage(table.linkage) if table.linkage else None
    structural = effects_of_variant(table.variant, linkage, file)
    return Model(
        name=table.name,
        serial=serial,
        axes=(*axes, *base),
        joints=(*joints, *base),
        transmission=_with_base(matrix, len(base)),
        actuators=_actuators(table.actuators, n, len(base), file),
        closed_chain=_mechanism(table, n, file),
        posture_dependent=bool(table.transmission and table.transmission.posture_dependent),
        linkage=linkage,
        variant=table.variant,
        effects=(*structural, *(e for entry in table.effects for e in effects_of_entry(entry, axes, file))),
        controller=_controller(table, n, file),
        payload_site=payload_site,
        sliding_speed=table.friction.sliding_speed,
        friction_as_in_mjcf=table.friction.as_in_mjcf,
        flank_retardation_s=table.backlash.retardation_s,
        ground=_ground(table.ground, spec, file),
        floats=bool(base),
        source=file,
    )


def _with_base(matrix: np.ndarray, base: int) -> np.ndarray:
    """Return a transmission extended by the axes of a floating base, each a joint of its own."""
    out, n = np.eye(len(matrix) + base), len(matrix)
    out[:n, :n] = matrix
    return out


def _resolve(file: Path, name: str, key: str) -> Path:
    for folder in (file.parent, models_folder()):
        with contextlib.suppress(OSError):  # a name longer than the system allows
            if (folder / name).is_file():
                return (folder / name).resolve()
    raise InputError(
        f"'{name}' does not exist", file=file, column=key, remedy="give a path relative to this file"
    )


def _per_axis(value: list[float] | float, n: int, file: Path, key: str) -> tuple[float, ...]:
    values = [value] * n if isinstance(value, (int, float)) else value
    if len(values) != n:
        raise InputError(
            f"{len(values)} values for {n} axes", file=file, column=key, remedy="give one per axis"
        )
    return tuple(float(v) for v in values)


def _transmission(
    table: ModelTable, known: list[str], file: Path
) -> tuple[tuple[str, ...], tuple[str, ...], np.ndarray]:
    """Return axes, joints and the matrix (n, n) between them; without a table the joints are driven.

    Args:
        table: the model file.
        known: joints of the MJCF.
        file: for errors.
    """
    given = table.transmission
    joints = given.joints if given else (table.axes or known)
    axes = table.axes or joints
    n = len(axes)
    for joint in joints:
        if joint not in known:
            raise InputError(
                f"the MJCF has no joint '{joint}'", file=file, column="transmission.joints",
                remedy=f"joints are {', '.join(known)}",
            )  # fmt: skip
    if len(set(axes)) != n or len(set(joints)) != len(joints):
        raise InputError("a name is given twice", file=file, column="axes", remedy="name each axis once")
    rows = np.eye(n).tolist() if given is None or given.matrix is None else given.matrix
    if n == 0 or len(joints) != n or len(rows) != n or any(len(row) != n for row in rows):
        raise InputError(
            f"{n} axes, {len(joints)} joints and matrix rows of {[len(row) for row in rows]} numbers",
            file=file, column="transmission",
            remedy="the matrix must be square, one row per axis and one column per joint",
        )  # fmt: skip
    matrix = np.array(rows, float)
    if not np.linalg.cond(matrix) < _SINGULAR:
        raise InputError(
            "the transmission matrix is singular", file=file, column="transmission.matrix",
            remedy="its rows must be independent: no row may be a combination of the others",
        )  # fmt: skip
    return tuple(axes), tuple(joints), matrix


def _actuators(table: ActuatorTable, n: int, base: int, file: Path) -> Actuators:
    """Return actuators of n drives; the axes of a floating base have none."""
    return Actuators(
        (*_per_axis(table.inertia, n, file, "actuators.inertia"), *[0.0] * base),
        (*_per_axis(table.damping, n, file, "actuators.damping"), *[0.0] * base),
        (*_per_axis(table.torque_limit, n, file, "actuators.torque_limit"), *[float("inf")] * base),
        table.delay_s,
        table.full_braking,
    )


def _payload_site(table: ModelTable, spec: mujoco.MjSpec, file: Path) -> str | None:
    if table.payload is None:
        return end_site(spec)
    if all(site.name != table.payload.site for site in spec.sites):
        raise InputError(
            f"the MJCF has no site '{table.payload.site}'", file=file, column="payload.site",
            remedy=f"sites are {', '.join(s.name for s in spec.sites if s.name) or 'none: add one'}",
        )  # fmt: skip
    return table.payload.site


def _linkage(table: LinkageTable) -> Linkage:
    crank = Crank(**table.crank.model_dump()) if table.crank else None
    return Linkage(**table.model_dump(exclude={"crank"}), crank=crank)


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
                remedy="name one joint of the closed chain per axis",
            )  # fmt: skip
    if chain.limits and (len(chain.limits) != n or any(low >= high for low, high in chain.limits)):
        raise InputError(
            f"limits are not {n} pairs of a lower and a higher number", file=file,
            column="closed_chain.limits", remedy="give one pair per serial joint",
        )  # fmt: skip
    return Mechanism(
        _resolve(file, chain.file, "closed_chain.file"),
        tuple(chain.drives),
        tuple(chain.joints),
        tuple(chain.loops),
        chain.foot,
        tuple(chain.start.items()),
        tuple(chain.limits),
        tuple(Coupling(c.joint, c.follows, tuple(c.polynomial)) for c in chain.couplings),
    )


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
                remedy=f"give {', '.join(needed)}, one value per axis",
            )  # fmt: skip
    return Controller(
        kind=c.kind, coordinates=c.coordinates, period_s=c.period_s, velocity=c.velocity, **per_axis
    )
