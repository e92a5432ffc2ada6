"""``workbench import``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from workbench.core import InputError

from .app import app
from .common import ForceOption, JsonOption, QuietOption, check_outputs, echo
from .import_table import import_table, read_answers


@app.command(name="import")
def import_(
    file: Annotated[
        str,
        typer.Argument(
            metavar="FILE",
            help="A table or log (CSV, Parquet, MATLAB, NumPy, MCAP, ROS 2 bag, LeRobot data set, CAN log), "
            "or SDF or URDF of a mechanism, its loops cut open.",
        ),
    ],
    output: Annotated[
        str,
        typer.Option(
            "--output", "-o", metavar="TOML", help="The new recording or model file; FILE.toml for a table."
        ),
    ] = "",
    model: Annotated[
        str | None,
        typer.Option("--model", metavar="MODEL", help="Table: the model whose axes the recording is for."),
    ] = None,
    column: Annotated[
        list[str] | None,
        typer.Option("--column", metavar="SIGNAL=A,B", help="Table: columns of a signal, one an axis."),
    ] = None,
    unit: Annotated[
        list[str] | None,
        typer.Option("--unit", metavar="KIND=UNIT", help="Table: unit of time, position, velocity, torque."),
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option("--rate", metavar="HZ", help="Table: rows a second; no column is time."),
    ] = None,
    counts: Annotated[
        float | None, typer.Option("--counts", metavar="N", help="Table: encoder counts per turn.")
    ] = None,
    coordinates: Annotated[
        str, typer.Option("--coordinates", metavar="WHERE", help="Table: 'actuator' or 'joint'.")
    ] = "",
    kp: Annotated[
        list[float] | None,
        typer.Option("--kp", help="Table: the loop's gain [N m/rad], one or each."),
    ] = None,
    kd: Annotated[
        list[float] | None, typer.Option("--kd", help="Table: the loop's damping [N m s/rad].")
    ] = None,
    period: Annotated[
        float | None, typer.Option("--period", metavar="S", help="Table: the loop's period.")
    ] = None,
    episode: Annotated[int, typer.Option("--episode", min=0, help="LeRobot: which episode.")] = 0,
    yes: Annotated[
        bool, typer.Option("--yes", "-y", help="Table: take the likeliest answer to every question.")
    ] = False,
    json: JsonOption = None,
    drive: Annotated[
        list[str] | None,
        typer.Option("--drive", metavar="JOINT", help="A joint that a motor turns; in order."),
    ] = None,
    joint: Annotated[
        list[str] | None,
        typer.Option("--joint", metavar="JOINT", help="A serial joint, from the base to the foot."),
    ] = None,
    loop: Annotated[
        list[str] | None,
        typer.Option(
            "--loop", metavar="A:B", help="Two frames that coincide; not needed if the file says so."
        ),
    ] = None,
    foot: Annotated[
        str | None, typer.Option("--foot", metavar="FRAME", help="The frame at the foot.")
    ] = None,
    axis: Annotated[
        list[str] | None,
        typer.Option("--axis", metavar="NAME", help="Name of a drive in recordings; in order."),
    ] = None,
    limits: Annotated[
        list[str] | None,
        typer.Option(
            "--limits", metavar="JOINT=LOW:HIGH", help="Range of a serial joint; else the file's own."
        ),
    ] = None,
    start: Annotated[
        list[str] | None,
        typer.Option(
            "--start", metavar="JOINT=ANGLE", help="A joint's angle near a closed posture; picks the branch."
        ),
    ] = None,
    gear: Annotated[
        list[float] | None, typer.Option("--gear", help="Gear ratio, one for all drives or one each.")
    ] = None,
    rotor_inertia: Annotated[
        list[float] | None,
        typer.Option("--rotor-inertia", help="At the rotor [kg m^2], one for all or one each."),
    ] = None,
    rotor_damping: Annotated[
        list[float] | None,
        typer.Option("--rotor-damping", help="At the rotor [N m s/rad], one for all or one each."),
    ] = None,
    torque_limit: Annotated[
        list[float] | None,
        typer.Option("--torque-limit", help="At the output [N m], one for all or one each."),
    ] = None,
    delay: Annotated[
        float, typer.Option("--delay", min=0.0, max=1.0, help="From command to torque [s].")
    ] = 0.0,
    force: ForceOption = False,
    quiet: QuietOption = False,
) -> None:
    """Make a recording of any table or log, or a model of your own leg from an SDF or URDF with a loop.

    Of a table it finds time, joints, quantities and units, shows what it assumes, and asks what it cannot
    tell; the source is not changed. Of an SDF or URDF without --drive it lists joints and frames.

    Example: workbench import run.csv --model arm.xml -o run.toml

    Example: workbench import leg.sdf --drive hip --drive crank_pin --joint hip --joint knee
    --loop coupler_end:rear_arm_end --foot foot --gear 9 --rotor-inertia 2e-4 -o my_leg.toml
    """
    from workbench.core import Mechanism
    from workbench.importing import Drives, contents_of, import_model

    path = Path(file)
    if path.suffix.lower() not in (".sdf", ".urdf", ".xml", ".xacro", ".world"):
        answers = read_answers(axis, column, unit, rate, counts, coordinates, kp, kd, period, model)
        check_outputs(json, force=force)
        import_table(path, output, answers, episode=episode, yes=yes, json=json, force=force, quiet=quiet)
        return
    contents = contents_of(path)
    if not drive:
        echo(str(contents))
        return
    if not output:
        raise InputError("no output file", remedy="say where the new model goes: -o MODEL.toml")
    serial = tuple(joint or ())
    stated = {**contents.limits, **{k: _range(v) for k, v in _pairs(limits, "--limits").items()}}
    known = [name for name in serial if name in stated]
    if known and len(known) < len(serial):
        missing = next(name for name in serial if name not in stated)
        raise InputError(
            f"joint '{missing}' has no limits", file=path, remedy=f"give --limits {missing}=LOW:HIGH"
        )
    mechanism = Mechanism(
        file=path,
        drives=tuple(drive),
        joints=serial,
        loops=tuple(_frames(pair) for pair in loop or ()),
        foot=foot,
        start=tuple((k, _number(v)) for k, v in _pairs(start, "--start").items()),
        limits=tuple(stated[name] for name in serial) if known else (),
    )
    count = len(drive)
    drives = Drives(
        _each(gear, count, 1.0, "--gear"),
        _each(rotor_inertia, count, 0.0, "--rotor-inertia"),
        _each(rotor_damping, count, 0.0, "--rotor-damping"),
        _each(torque_limit, count, float("inf"), "--torque-limit"),
        delay,
    )
    made = import_model(mechanism, drives, output, axes=axis, force=force)
    if quiet:
        return
    kind = "changes with the posture" if made.posture_dependent else "is constant"
    echo(f"Wrote {output} and {made.serial.name}: the transmission {kind}: {made.transmission.tolist()}.")
    if made.linkage is not None:
        sizes = {k: v for k, v in vars(made.linkage).items() if k != "identified"}
        echo(
            "A parallelogram; over the serial tree its linkage has "
            + ", ".join(f"{k} = {v:.6g} {'kg m²' if k[0] == 'M' else 'N m'}" for k, v in sizes.items())
            + "."
        )
    echo(f"Next: workbench check {output}")


def _pairs(texts: list[str] | None, option: str) -> dict[str, str]:
    out = {}
    for text in texts or []:
        name, equals, value = text.partition("=")
        if not (name and equals and value):
            raise InputError(f"{option} '{text}' is not NAME=VALUE", remedy=f"e.g. {option} knee=...")
        out[name] = value
    return out


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
