"""``workbench can``."""

from __future__ import annotations

import contextlib
import os
import signal
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from typer import Argument, Option

from workbench.core.text import counted

from . import options
from .common import check_outputs, echo, whole, write_result, wrote
from .hidden import HideOption, SetOption
from .listing import Listing

if TYPE_CHECKING:
    from rich.table import Table

    from workbench.can import BusLoad

_AFTERWARDS = 2.0  # s that are logged after the host is gone: what the drives then do

can = typer.Typer(
    name="can",
    cls=Listing,
    no_args_is_help=True,
    help="Show buses, drives and their limits, from a configuration. Example: workbench can load robot.toml",
)

ConfigArgument = Annotated[
    str, Argument(metavar="CONFIG", help="CAN configuration: buses, motors, limits (.toml).")
]


@can.command()
def load(
    config: ConfigArgument,
    json: options.Json = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Compute the largest load of each bus; exit code 1 above 70 %.

    Example: workbench can load robot.toml
    """
    from workbench.can import MOST, bus_load, load_config
    from workbench.report import print_table

    check_outputs(json, force=force)
    loads = bus_load(load_config(config))
    if json:
        buses = [{**vars(each), "fits": each.fits} for each in loads]
        made = {"format": 1, "most": MOST, "buses": buses}
        write_result(made, json, files=[Path(config)], force=force)
    if not quiet and json != "-":
        print_table(_table(loads))
    full = [each.bus for each in loads if not each.fits]
    if full:
        echo(f"The load is too high on {', '.join(full)}; use more buses or a longer period.", err=True)
        raise typer.Exit(1)


def _table(loads: Sequence[BusLoad]) -> Table:
    from workbench.report.layout import table

    out = table("bus", ("motors", "right"), ("frames/s", "right"), ("worst load", "right"))
    for each in loads:
        share = f"{100 * each.share:.0f} %"
        out.add_row(each.bus, str(each.motors), f"{each.frames:.0f}", share if each.fits else f"{share} !")
    return out


@can.command()
@whole
def dbc(
    config: ConfigArgument,
    output: Annotated[str, options.written("--output", "-o", metavar="FILE", help="The DBC file.")],
    json: options.Json = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Write a DBC of the drives, so that other tools can read the logs.

    Example: workbench can dbc robot.toml -o robot.dbc
    """
    from workbench.can import dbc as text
    from workbench.can import load_config, make_drive
    from workbench.can.imu import IMUS
    from workbench.core.files import write_whole

    check_outputs(output, json, force=force)
    loaded = load_config(config)
    imu = IMUS[loaded.imu.protocol](loaded.imu.id) if loaded.imu else None
    drives = {motor.axis: make_drive(motor) for motor in loaded.motor}
    write_whole(output, text(drives, imu), force=force)
    if json:
        made = {"format": 1, "file": output, "drives": list(drives), "imu": imu is not None}
        write_result(made, json, files=[Path(config)], force=force)
    if not quiet and json != "-":
        without = [motor.axis for motor in loaded.motor if motor.protocol == "moteus"]
        none = (
            f" A DBC cannot describe a moteus, so the file leaves out {', '.join(without)}."
            if without
            else ""
        )
        wrote(f"Wrote {output}: the frames of {counted(len(drives) - len(without), 'drive')}.{none}")


@can.command()
def bus(config: ConfigArgument) -> None:
    """Run the buses with interface "workbench" between processes, until interrupted.

    Example: workbench can bus robot.toml
    """
    from workbench.can import load_config
    from workbench.can.realtime import realtime
    from workbench.can.server import serve

    stop, loaded = _until_told(), load_config(config)
    with realtime():
        serve(loaded, stop, lambda: echo("ready"))


@can.command()
def motors(
    config: ConfigArgument,
    hide: HideOption = None,
    set_: SetOption = None,
    seed: options.Seed = 0,
    row_ms: Annotated[float, Option(min=0.1, max=2.0, help="Cycle of the drives' control [ms].")] = 0.5,
) -> None:
    """Run virtual motors on the buses; they turn virtual legs and single actuators, until interrupted.

    Example: workbench can motors robot.toml --hide coulomb_friction@knee --set torque=0.25
    """
    from workbench.can import load_config
    from workbench.can.realtime import realtime
    from workbench.deployment.motors import run_motors

    from .record_can import virtual_motors

    stop = _until_told()
    loaded = load_config(config)
    bank = virtual_motors(loaded, (hide, set_), lambda text: echo(text, err=True))(seed, 1e-3 * row_ms)
    with realtime():
        run_motors(loaded, bank, stop, lambda: echo("ready"))
    longest = max(motor.longest for motor in bank.motors.values())
    driving = [motor.axis for motor in bank.motors.values() if motor.enabled]
    echo(f"longest without a command: {1e3 * longest:.2f} ms; driving: {', '.join(driving) or 'none'}")


@can.command()
def virtual(
    config: ConfigArgument, hide: HideOption = None, set_: SetOption = None, seed: options.Seed = 0
) -> None:
    """Run buses and virtual motors as two processes, until interrupted.

    Example: workbench can virtual robot.toml
    """
    from workbench.deployment.processes import virtual_hardware

    stop = _until_told()
    words = [*(["--hide", hide] if hide else []), *(w for each in set_ or [] for w in ("--set", each))]
    with virtual_hardware(config, ["--seed", str(seed), *words], aloud=True) as running:
        echo("ready")
        while running() and not stop():
            time.sleep(0.05)
    if not stop():
        echo("The virtual hardware ended by itself; its buses are closed.", err=True)
        raise typer.Exit(1)


@can.command()
def log(
    config: ConfigArgument,
    output: Annotated[str, options.written("--output", "-o", metavar="FILE", help="The candump log.")],
    parent: Annotated[int, Option(help="End after this process, if it started this one.")] = 0,
    force: options.Force = False,
) -> None:
    """Log every frame of the buses as candump does, until interrupted.

    Example: workbench can log robot.toml -o today.log
    """
    from workbench.can import load_config
    from workbench.core.files import check_free
    from workbench.deployment.logger import log_buses

    stop, path, loaded = _until_told(), Path(output), load_config(config)
    for file in (path, path.with_suffix(".clock")):
        check_free(file, force=force)
        file.unlink(missing_ok=True)
    alone: list[float] = []  # since when

    def over() -> bool:
        if parent and os.getppid() != parent:
            alone.append(time.monotonic())
        return stop() or bool(alone and time.monotonic() > alone[0] + _AFTERWARDS)

    count = log_buses(loaded, path, over, lambda: echo("ready"))
    with contextlib.suppress(OSError):  # whoever started this is gone, and with it its end of the pipe
        echo(f"Logged {count} frames.")


def _until_told() -> Callable[[], bool]:
    """Whether the process was asked to end."""
    told: list[int] = []
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda n, _: told.append(n))
    return lambda: bool(told)
