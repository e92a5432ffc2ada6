"""``workbench import``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from workbench.core import InputError

from . import complete, options
from .common import check_outputs, found
from .import_model import import_mechanism, refuse_model, show_contents
from .import_table import import_several, import_table, read_answers
from .mechanism_options import MechanismOptions

_MECHANISMS = (".sdf", ".urdf", ".xml", ".xacro", ".world")


def import_(
    files: Annotated[
        list[str],
        Argument(
            metavar="FILE...",
            help="A table or log (CSV, JSON, Parquet, MATLAB, NumPy, PyTorch, MCAP, ROS 2 bag, LeRobot data "
            "set, CAN log); or a mechanism: SDF or URDF (loops cut open), or MJCF with loops. "
            "Several similar logs are imported together, and each question is asked once.",
        ),
    ],
    output: Annotated[
        str,
        options.written(
            "--output",
            "-o",
            metavar="TOML",
            help="The new recording or model file; FILE.toml for a table, a folder for several.",
        ),
    ] = "",
    model: Annotated[
        str | None,
        Option(
            metavar="MODEL",
            help="Table: the model whose axes the recording is for.",
            autocompletion=complete.models,
        ),
    ] = None,
    column: Annotated[
        list[str] | None, Option(metavar="SIGNAL=A,B", help="Table: columns of a signal, one per axis.")
    ] = None,
    unit: Annotated[
        list[str] | None,
        Option(
            metavar="KIND=UNIT",
            help="Table: unit of time, position, velocity, torque; or one per axis: position=deg,deg,mm,deg.",
        ),
    ] = None,
    rate: Annotated[
        float | None, Option(metavar="HZ", help="Table: rows per second, if no column is time.")
    ] = None,
    counts: Annotated[float | None, Option(metavar="N", help="Table: encoder counts per turn.")] = None,
    coordinates: Annotated[str, Option(metavar="WHERE", help="Table: 'actuator' or 'joint'.")] = "",
    kp: Annotated[
        list[float] | None,
        Option(min=0.0, help="The loop's gain [N m/rad; N/m of a slide], one value or one per axis."),
    ] = None,
    kd: Annotated[list[float] | None, Option(min=0.0, help="The loop's damping [N m s/rad; N s/m].")] = None,
    period: Annotated[float | None, Option(metavar="S", help="The loop's period.")] = None,
    episode: Annotated[
        int | None,
        Option(min=0, metavar="K", help="LeRobot, or a log of several runs: number of the run, from 0."),
    ] = None,
    yes: Annotated[
        bool, Option("--yes", "-y", help="Table: take the likeliest answer to every question.")
    ] = False,
    json: options.Json = None,
    drive: Annotated[
        list[str] | None, Option(metavar="JOINT", help="A joint that a motor turns; in order.")
    ] = None,
    joint: Annotated[
        list[str] | None, Option(metavar="JOINT", help="A serial joint, from the base to the foot.")
    ] = None,
    loop: Annotated[
        list[str] | None,
        Option(metavar="A:B", help="Two frames that coincide; not needed if the file says so."),
    ] = None,
    foot: Annotated[str | None, Option(metavar="FRAME", help="The frame at the foot.")] = None,
    axis: Annotated[
        list[str] | None, Option(metavar="NAME", help="Name of a drive in recordings; in order.")
    ] = None,
    limits: Annotated[
        list[str] | None,
        Option(metavar="JOINT=LOW:HIGH", help="Range of a serial joint; default: the file's own."),
    ] = None,
    start: Annotated[
        list[str] | None,
        Option(metavar="JOINT=ANGLE", help="A joint's angle near a closed posture; picks the branch."),
    ] = None,
    hold: Annotated[
        list[str] | None,
        Option(
            metavar="JOINT=ANGLE",
            help="A joint without a drive that stays at this position, such as one on a stiff spring.",
        ),
    ] = None,
    hold_rest: Annotated[
        bool,
        Option(
            "--hold-rest",
            help="Hold all joints that neither drives nor loops move, to import one limb of a whole robot.",
        ),
    ] = False,
    gear: Annotated[
        list[float] | None, Option(help="Gear ratio, one for all drives or one per drive.")
    ] = None,
    rotor_inertia: Annotated[
        list[float] | None, Option(help="At the rotor [kg m^2], one for all or one per drive.")
    ] = None,
    rotor_damping: Annotated[
        list[float] | None, Option(help="At the rotor [N m s/rad], one for all or one per drive.")
    ] = None,
    torque_limit: Annotated[
        list[float] | None, Option(help="At the output [N m], one for all or one per drive.")
    ] = None,
    delay: Annotated[float, Option(min=0.0, max=1.0, help="From command to torque [s].")] = 0.0,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Make a recording of any table or log, or a model of your own leg from an SDF, URDF or MJCF with a loop.

    Of a table it finds time, joints, quantities and units, shows what it assumes, and asks what it cannot
    tell; the source is not changed. Of an SDF or URDF without --drive it lists joints and frames.

    Example: workbench import run.csv --model arm.xml -o run.toml

    Example: workbench import logs/*.csv --model arm.xml -o recordings

    \b
    Example: workbench import leg.sdf --drive hip --drive crank_pin --joint hip
    --joint knee --loop coupler_end:rear_arm_end --foot foot --gear 9
    --rotor-inertia 2e-4 -o my_leg.toml
    """
    from workbench.models import packaged_robot

    paths = [packaged_robot(file) or Path(file) for given in files for file in found(given)]
    path = paths[0]
    check_outputs(json, force=force)
    if output and len(paths) == 1:
        options.check_ending(output, ".toml")
    if len(paths) > 1:
        if mechanism := next((p for p in paths if p.suffix.lower() in _MECHANISMS), None):
            raise InputError(
                "a mechanism is imported alone", file=mechanism, remedy="give it without the logs"
            )
        answers = read_answers(axis, column, unit, rate, counts, coordinates, kp, kd, period, model, episode)
        import_several(paths, output, answers, yes=yes, model=model, json=json, force=force, quiet=quiet)
        return
    if path.suffix.lower() not in _MECHANISMS:
        answers = read_answers(axis, column, unit, rate, counts, coordinates, kp, kd, period, model, episode)
        import_table(path, output, answers, yes=yes, model=model, json=json, force=force, quiet=quiet)
        return
    refuse_model(path)
    if not drive:
        show_contents(path, json, force, quiet)
    else:
        asked = MechanismOptions(
            path, drive, joint or [], loop or [], foot, limits or [], start or [], hold or [], gear,
            rotor_inertia, rotor_damping, torque_limit, delay, kp, kd, period, coordinates, hold_rest,
        )  # fmt: skip
        import_mechanism(asked, output, axis, json, force, quiet)
