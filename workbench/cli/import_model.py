"""``workbench import`` of an SDF or URDF: a model of a leg with a loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from workbench.core import InputError

from .common import echo, named_values, write_result


@dataclass(frozen=True)
class MechanismOptions:
    """What the command line says about a mechanism; text as it was given."""

    file: Path
    drives: Sequence[str]
    joints: Sequence[str]
    loops: Sequence[str]
    foot: str | None
    limits: Sequence[str]
    start: Sequence[str]
    gear: list[float] | None
    rotor_inertia: list[float] | None
    rotor_damping: list[float] | None
    torque_limit: list[float] | None
    delay: float


def refuse_model(path: Path) -> None:
    """An MJCF needs no import, or has a loop that cannot be imported.

    Raises:
        InputError: the file is one.
    """
    from workbench.core.xml import parse_xml
    from workbench.models import load_mjcf

    if not path.is_file():
        return  # said where it is opened
    remedy = "give an SDF or URDF file"
    if parse_xml(path.read_bytes(), path, problem="not an XML file", remedy=remedy).tag == "mujoco":
        load_mjcf(path)  # says what of it is no model
        raise InputError(
            "it is an MJCF, which is a model already",
            file=path,
            remedy=f"use it as it is: workbench import LOG --model {path}, workbench compare {path} RUN.toml",
        )


def show_contents(path: Path, json: str | None, force: bool, quiet: bool) -> None:
    """Say which joints and frames a file has.

    Raises:
        InputError: it cannot be read.
    """
    from workbench.importing import contents_of

    found = contents_of(path)
    if json:
        content = {"format": 1, **vars(found)}
        write_result(content, json, files=[path], force=force)
    if not quiet and json != "-":
        echo(str(found))
        echo("Name drives and joints to make a model: --drive JOINT... --joint JOINT... -o MODEL.toml")


def import_mechanism(
    asked: MechanismOptions, output: str, axes: list[str] | None, json: str | None, force: bool, quiet: bool
) -> None:
    """Write a model of the mechanism, and say what it is.

    Raises:
        InputError: an option that is not of its form, or a mechanism that cannot be made of the file.
    """
    from workbench.core import Mechanism
    from workbench.importing import Drives, assemblies, contents_of, import_model
    from workbench.models import linkage_table

    path, serial = asked.file, tuple(asked.joints)
    contents = contents_of(path)
    if not output:
        raise InputError("no output file", remedy="say where the new model goes: -o MODEL.toml")
    stated = {
        **contents.limits,
        **{k: _range(v) for k, v in named_values(asked.limits, "--limits", "knee=0.35:2.6").items()},
    }
    known = [name for name in serial if name in stated]
    if known and len(known) < len(serial):
        missing = next(name for name in serial if name not in stated)
        raise InputError(
            f"joint '{missing}' has no limits", file=path, remedy=f"give --limits {missing}=LOW:HIGH"
        )
    mechanism = Mechanism(
        file=path,
        drives=tuple(asked.drives),
        joints=serial,
        loops=tuple(_frames(pair) for pair in asked.loops),
        foot=asked.foot,
        start=tuple((k, _number(v)) for k, v in named_values(asked.start, "--start", "knee=1.2").items()),
        limits=tuple(stated[name] for name in serial) if known else (),
    )
    count = len(asked.drives)
    drives = Drives(
        _each(asked.gear, count, 1.0, "--gear"),
        _each(asked.rotor_inertia, count, 0.0, "--rotor-inertia"),
        _each(asked.rotor_damping, count, 0.0, "--rotor-damping"),
        _each(asked.torque_limit, count, float("inf"), "--torque-limit"),
        asked.delay,
    )
    made = import_model(mechanism, drives, output, axes=axes, force=force)
    ways = assemblies(mechanism)
    if json:
        content = {
            "format": 1,
            "model": made.name,
            "files": [output, str(Path(output).with_name(made.serial.name))],
            "axes": list(made.axes),
            "joints": list(made.joints),
            "transmission": made.transmission.tolist(),
            "posture_dependent": made.posture_dependent,
            "linkage": None if made.linkage is None else linkage_table(made.linkage),
            "assemblies": vars(ways),
        }
        write_result(content, json, files=[path], force=force)
    if quiet or json == "-":
        return
    kind = "changes with the posture" if made.posture_dependent else "is constant"
    echo(f"Wrote {output} and {made.serial.name}: the transmission {kind}: {made.transmission.tolist()}.")
    if made.linkage is not None:
        sizes = {k: v for k, v in vars(made.linkage).items() if k not in ("identified", "crank")}
        echo(
            "A parallelogram; over the serial tree its linkage has "
            + ", ".join(f"{k} = {v:.6g} {'kg m²' if k[0] == 'M' else 'N m'}" for k, v in sizes.items())
            + "."
        )
    if str(ways) and made.linkage is None:  # a parallelogram's other way is its folded twin
        echo(f"{ways}.")
    echo(f"Next: workbench check {output}")


def _frames(text: str) -> tuple[str, str]:
    first, colon, second = text.partition(":")
    if not (first and colon and second):
        raise InputError(f"--loop '{text}' is not A:B", remedy="name two frames of the file")
    return first, second


def _range(text: str) -> tuple[float, float]:
    low, _, high = text.partition(":")
    out = _number(low), _number(high)
    if not out[0] < out[1]:
        raise InputError(f"limits '{text}' are not LOW:HIGH", remedy="e.g. --limits knee=0.35:2.6")
    return out


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) < float("inf"):
        raise InputError(f"'{text}' is not a number", remedy="give a finite number")
    return value


def _each(values: list[float] | None, count: int, default: float, option: str) -> tuple[float, ...]:
    given = values or [default]
    if len(given) not in (1, count):
        raise InputError(
            f"{len(given)} values of {option} for {count} drives", remedy="give one, or one each"
        )
    if any(not v >= 0.0 for v in given):
        raise InputError(f"{option} is negative", remedy="give numbers of zero or more")
    return tuple(given * count if len(given) == 1 else given)
