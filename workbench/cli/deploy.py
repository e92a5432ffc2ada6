"""``workbench deploy``."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer import Argument, Option

from workbench.core import InputError

from . import options
from .common import check_outputs, echo, write_result
from .heartbeat import waiting

if TYPE_CHECKING:
    from workbench.can import CanConfig
    from workbench.deployment.simulated import SimulatedNetwork


def deploy(
    bundle: Annotated[
        str, Argument(metavar="BUNDLE", help="A policy bundle (.zip), or 'tracker': no network.")
    ],
    config: Annotated[str, Argument(metavar="CONFIG", help="CAN configuration (.toml).")],
    seconds: Annotated[float, Option(min=1.0, max=86400.0, help="How long it runs.")] = 60.0,
    dry_run: Annotated[
        bool, Option("--dry-run", help="Virtual motors in simulated time; no bus is touched.")
    ] = False,
    yes: Annotated[bool, Option("--yes", help="Move without asking.")] = False,
    cpu: Annotated[int | None, Option(min=0, help="Run on this processor only.")] = None,
    velocity: Annotated[
        tuple[float, float, float],
        Option(metavar="X Y TURN", help="Commanded velocity of a walking policy [m/s, m/s, rad/s]."),
    ] = (0.0, 0.0, 0.0),
    unapproved: Annotated[
        bool, Option("--unapproved", help="Drive hardware with a policy that is not approved.")
    ] = False,
    watchdogs_tested: Annotated[
        bool,
        Option(
            "--watchdogs-tested",
            help="Confirm that you saw each drive stop without its host; permits full torque.",
        ),
    ] = False,
    teleop: Annotated[
        str,
        Option(metavar="HOW", help="Change the commanded velocity: keys (w s q e a d x), pad, or udp:PORT."),
    ] = "",
    output: Annotated[
        str | None,
        options.written(
            "--output",
            "-o",
            folder=True,
            metavar="FOLDER",
            help="Folder for the run's frames and its recording; default for hardware: deployed/DATE.",
        ),
    ] = None,
    seed: options.Seed = 0,
    json: options.Json = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Run a policy over CAN; an interrupt is the emergency stop. Exit code 1 if a fault ended it.

    Example: workbench deploy reach.zip robot.toml --dry-run
    """
    from workbench.bundle import read_bundle
    from workbench.can import load_config
    from workbench.deployment.deploy import deploy as run
    from workbench.deployment.ports import unheard
    from workbench.deployment.stopping import exit_code

    check_outputs(json, force=force)
    robot = load_config(config)
    if output is None and not dry_run:  # what a robot did is kept unless somebody says otherwise
        alone = unheard(robot)
        output = "" if alone else f"deployed/{time.strftime('%Y-%m-%d_%H-%M-%S')}"
        if alone and not quiet:
            echo(f"This run is not recorded: {alone.interface} serves one process at a time.", err=True)
    log = _new_log(Path(output), force) if output else None
    policy = None if bundle == "tracker" else read_bundle(bundle)

    def confirm() -> None:
        if not (dry_run or yes):
            with waiting():
                typer.confirm(
                    f"This moves {', '.join(robot.axes)}. Is everybody clear?", abort=True, err=True
                )

    say = (lambda line: None) if quiet else (lambda line: print(line, file=sys.stderr, flush=True))
    if not all(map(math.isfinite, velocity)):
        raise InputError("a velocity is not a number", remedy="give three: --velocity 0.4 0 0")
    result = run(
        robot, policy, seconds, seed=seed, twist=velocity, unapproved=unapproved,
        watchdogs_tested=watchdogs_tested, teleop=teleop, cpu=cpu, say=say, confirm=confirm,
        network=(lambda: _virtual(robot, seed, say)) if dry_run else None, log=log,
    )  # fmt: skip
    if json:
        read = [Path(config), *([Path(bundle)] if policy else [])]
        read += _model_files(robot)
        write_result({"format": 1, **result}, json, files=read, seeds={"run": seed}, force=force)
    if not quiet and json != "-":
        trip = result["round_trip_ms"]
        echo(
            f"{result['ticks']} ticks, {100 * result['missed_share']:.2g} % of the ticks missed; round "
            f"trip {trip['p50']:.3g} ms (median), {trip['p99']:.3g} ms (99th percentile)."
        )
        echo(_ending(result))
    if log:
        said = _kept(robot, log, force)
        if not quiet and json != "-":
            echo(said)
    if code := exit_code(result):
        raise typer.Exit(code)


def _virtual(robot: CanConfig, seed: int, say: Callable[[str], object]) -> SimulatedNetwork:
    """Virtual motors that turn what the configuration's models are, in simulated time.

    Raises:
        InputError: a mechanism that no virtual hardware can be made of, or, as on a robot's own computer, the
            simulator is not installed.
    """
    try:
        from workbench.deployment.simulated import SimulatedNetwork

        from .record_can import virtual_motors

        return SimulatedNetwork(robot, virtual_motors(robot, (None, None), say)(seed, None))
    except ImportError as error:
        raise InputError(
            f"a dry run needs the whole workbench: {error.name} is missing",
            remedy="make it on another computer",
        ) from error


def _new_log(folder: Path, force: bool) -> Path:
    """Where the frames of a run go. Nothing is made or removed yet: the run may be refused.

    Raises:
        InputError: something is there already, or nothing can be written there.
    """
    from workbench.core.files import check_free, check_place
    from workbench.deployment.kept import PLAYED

    log = folder / "run.log"
    for file in (log, *(log.with_suffix(end) for end in (".toml", ".blf", ".clock", PLAYED))):
        check_free(file, force=force)
    check_place(log)
    return log


def _kept(robot: CanConfig, log: Path, force: bool) -> str:
    """Makes a recording of a run, if one can be made; what became of it, in a line."""
    try:
        from workbench.deployment.record import from_run, keep

        return f"Wrote {keep(from_run(robot, log), log.parent, log, force)}."
    except ImportError:
        again = f"workbench record {robot.source} --from-logs -o {log.parent}"
        return (
            f"Wrote {log}; the packages that make a recording of it are not installed here. On another "
            f"computer: {again}"
        )
    except InputError as error:
        return f"No recording: {error}"


def _model_files(robot: CanConfig) -> list[Path]:
    """Files of the models that give transmissions."""
    models = [each.model for each in robot.mechanism if not each.transmission]
    if not models:  # a robot's own computer has nothing that reads models
        return []
    from workbench.models import read_model

    return [file for model in models for file in read_model(model).files]


def _ending(result: dict[str, Any]) -> str:
    """How a run ended, in a line."""
    if not result["fault"]:
        return "No fault."
    words = result["fault_words"] or [""] * len(result["fault_axes"])
    who = [
        f"{axis}: {said}" if said else axis for axis, said in zip(result["fault_axes"], words, strict=True)
    ]
    of = f" ({', '.join(who)})" if who else ""
    by = f", by {result['stopped_by']}" if result["stopped_by"] else ""
    return f"Ended by a fault: {result['fault']}{of}{by}."
