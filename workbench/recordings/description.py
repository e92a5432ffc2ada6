"""The TOML file of a recording: its allowed content, and a clear error line for anything else."""

from __future__ import annotations

import re
import shlex
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, FiniteFloat, ValidationError

from workbench.core import AXIS_SIGNALS, InputError
from workbench.core.files import check_format, read_file
from workbench.core.grammar import explained, unknown_key
from workbench.core.text import counted
from workbench.core.unfinished import finish
from workbench.core.units import KINDS


def _listed(value: Any) -> Any:
    """Return a list: a scalar counts as a list of one."""
    return value if isinstance(value, list) else [value]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class Column(_Table):
    """One column of the table; ``scale * cell + offset`` is in the unit that [units] states."""

    column: str
    scale: FiniteFloat = 1.0
    offset: FiniteFloat = 0.0


def _column(value: Any) -> Any:
    return {"column": value} if isinstance(value, str) else value


def _lines(value: Any) -> Any:
    """Return the excited harmonics: a grid's name, or their numbers, ascending."""
    if isinstance(value, list) and value and all(type(k) is int and k > 0 for k in value):
        return tuple(sorted(set(value)))
    if isinstance(value, str) and re.fullmatch(r"full|odd|odd_random|every_[1-9]\d{0,8}", value):
        return value
    # pydantic's own text for a choice of kinds takes a line for each
    message = "must be 'full', 'odd', 'odd_random', 'every_N' (as 'every_4') or a list of line numbers"
    raise ValueError(message)


AnyColumn = Annotated[Column, BeforeValidator(_column)]
Columns = Annotated[list[AnyColumn], BeforeValidator(_listed)]
Number = Annotated[float, Field(ge=-1e12, le=1e12)]  # no gain or period is larger, and its square is a number
NotNegative = Annotated[Number, Field(ge=0.0)]
Positive = Annotated[Number, Field(gt=0.0)]
Gains = Annotated[list[NotNegative], BeforeValidator(_listed)]
Limits = Annotated[list[Positive], BeforeValidator(_listed)]
Lines = Annotated[str | tuple[int, ...], BeforeValidator(_lines)]
UnitNames = Annotated[list[str], BeforeValidator(_listed)]


class ControllerTable(_Table):
    """``[controller]``; see `workbench.core.Controller`."""

    kind: Literal["none", "pd", "cascade_pv", "unknown"]
    coordinates: Literal["joint", "actuator"] = "actuator"
    kp: Gains | None = None
    kd: Gains | None = None
    kv: Gains | None = None
    gain: Gains | None = None
    limit: Limits | None = None
    period_s: Positive | None = None
    velocity: Literal["sensor", "difference"] | None = None


class ExcitationTable(_Table):
    """``[excitation]``; see `workbench.core.Excitation`."""

    kind: Literal["chirp", "multisine", "reference", "policy", "hold", "random"] = "reference"
    mode: Literal["sum", "difference", "single"] | None = None
    period_s: Positive | None = None
    f_min_hz: NotNegative | None = None
    f_max_hz: Positive | None = None
    lines: Lines | None = None


class TimingTable(_Table):
    """``[timing]``; see `workbench.core.Timing`."""

    feedforward_held: bool = True
    reference_held: bool | None = None
    stepped: bool | None = None
    soft_friction: bool | None = None
    initial_at_rest: bool = True
    delay: Literal["motor", "loop"] = "motor"


class Description(_Table):
    """The whole TOML file; `columns` and `units` are checked later by name."""

    format: Literal[1]
    name: str | None = None
    table: str
    rig: str = ""
    coordinates: Literal["actuator", "joint"] = "actuator"
    axes: Annotated[list[str], BeforeValidator(_listed)]
    columns: dict[str, Columns]
    units: dict[str, UnitNames] = {}
    guessed_units: list[str] = []
    controller: ControllerTable | None = None
    excitation: ExcitationTable = ExcitationTable()
    timing: TimingTable = TimingTable()


_COLUMN_KEYS = ("time", "valid", "ground_force", *AXIS_SIGNALS)


def is_extra(signal: str) -> bool:
    """Return whether a key of ``[columns]`` is kept beside the axis signals (any number of columns)."""
    return signal == "ground_force" or signal.startswith("base_")


def read_description(path: Path) -> Description:
    """Parse and check a recording's TOML file.

    Raises:
        InputError: missing or malformed file, or a key or value that the format does not have.
    """
    finish(path.parent)
    try:
        text = read_file(path).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        remedy = _other_kind(path, {}) or "give the recording's TOML file"
        raise InputError("is not a recording", file=path, remedy=remedy) from error
    content: dict[str, Any] = {}
    try:
        content = tomllib.loads(text)
        check_format(content, 1, path)
        if remedy := _other_kind(path, content):
            raise InputError("is not a recording", file=path, remedy=remedy)
        description = Description.model_validate(content)
    except tomllib.TOMLDecodeError as error:
        if remedy := _other_kind(path, content):
            raise InputError("is not a recording", file=path, remedy=remedy) from error
        raise InputError(f"is not valid TOML: {error}", file=path, remedy="correct that line") from error
    except ValidationError as error:
        if error.errors()[0]["loc"] == ("format",):
            found = content.get("format", "(none)")
            raise InputError(
                f"format {found} is not known to this version", file=path, column="format",
                remedy="write format = 1",
            ) from error  # fmt: skip
        raise explained(error, Description, content, path) from error
    _check_names(description, path)
    return description


def is_model_file(path: Path) -> bool:
    """Whether a file is a model, not a recording: an MJCF or URDF, or a TOML with the key ``serial``."""
    if path.suffix.lower() in (".xml", ".urdf"):
        return True
    if path.suffix.lower() != ".toml":
        return False
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return False  # whoever reads it says what is wrong with it
    return "serial" in content and "table" not in content


def _other_kind(path: Path, content: Mapping[str, Any]) -> str:
    """Return what to do with a file that is a model or a table; empty if it may be a recording."""
    if path.suffix in (".xml", ".urdf") or "serial" in content:
        return "it is a model, which comes first: MODEL REC..."
    if path.suffix != ".toml":
        return f"make one of it: workbench import {shlex.quote(str(path))}"
    return ""


def _check_names(d: Description, path: Path) -> None:
    if not d.axes:
        raise InputError("names no axis", file=path, column="axes", remedy="give one name per axis")
    twice = sorted({a for a in d.axes if d.axes.count(a) > 1})
    if twice:
        problem, remedy = f"axis '{twice[0]}' is named twice", "give each axis its own name"
        raise InputError(problem, file=path, column="axes", remedy=remedy)
    for signal in d.columns:
        if signal not in _COLUMN_KEYS and not is_extra(signal):
            raise unknown_key(f"columns.{signal}", signal, _COLUMN_KEYS, path)
    for needed in ("time", "position"):
        if needed not in d.columns:
            remedy = f"name the table's {needed} under [columns]"
            raise InputError("is missing", file=path, column=f"columns.{needed}", remedy=remedy)
    n = len(d.axes)
    for signal, columns in d.columns.items():
        wanted = n if signal in AXIS_SIGNALS else len(columns) if is_extra(signal) else 1
        if len(columns) != wanted or not columns:
            problem = f"has {counted(len(columns), 'column')} where {wanted} are needed"
            each = "give one column per axis, in the order of axes"
            remedy = each if signal in AXIS_SIGNALS else "give one"
            raise InputError(problem, file=path, column=f"columns.{signal}", remedy=remedy)
    measured = [c.column for c in d.columns["position"]]
    if shared := sorted({c for c in measured if measured.count(c) > 1}):
        both = " and ".join(a for a, c in zip(d.axes, measured, strict=True) if c == shared[0])
        raise InputError(
            f"'{shared[0]}' is the position of {both}", file=path, column="columns.position",
            remedy="give each axis its own column",
        )  # fmt: skip
    forces = len(d.columns.get("ground_force", ()))
    if forces % 3:
        problem = f"has {counted(forces, 'column')}, which is not a multiple of three"
        remedy = "give fx, fy, fz for every foot"
        raise InputError(problem, file=path, column="columns.ground_force", remedy=remedy)
    for kind in d.guessed_units:
        if kind not in KINDS:
            raise unknown_key("guessed_units", kind, tuple(KINDS), path)
    for kind, units in d.units.items():
        if kind not in KINDS:
            raise unknown_key(f"units.{kind}", kind, tuple(KINDS), path)
        if len(units) not in (1, n):
            remedy = "give one unit, or one per axis"
            raise InputError(
                f"has {len(units)} units for {n} axes", file=path, column=f"units.{kind}", remedy=remedy
            )
