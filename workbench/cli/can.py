"""``workbench can``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from .app import app
from .common import ForceOption, JsonOption, QuietOption, check_outputs

if TYPE_CHECKING:
    from rich.table import Table

    from workbench.can import BusLoad

can = typer.Typer(
    no_args_is_help=True,
    help="Buses, drives and their limits, from a configuration. Example: workbench can load robot.toml",
)
app.add_typer(can, name="can")

ConfigArgument = Annotated[
    str, typer.Argument(metavar="CONFIG", help="CAN configuration: buses, motors, limits (.toml).")
]


@can.command()
def load(config: ConfigArgument, json: JsonOption = None, quiet: QuietOption = False) -> None:
    """How full each bus can get at worst; exit code 1 above 70 %.

    Example: workbench can load robot.toml
    """
    from workbench.can import MOST, bus_load, load_config
    from workbench.report import print_table, write_json

    check_outputs(json, force=True)
    loads = bus_load(load_config(config))
    if json:
        buses = [{**vars(each), "fits": each.fits} for each in loads]
        write_json({"format": 1, "most": MOST, "buses": buses}, json, force=True)
    if not quiet and json != "-":
        print_table(_table(loads))
    full = [each.bus for each in loads if not each.fits]
    if full:
        typer.echo(f"Too full: {', '.join(full)}; use more buses or a longer period.", err=True)
        raise typer.Exit(1)


def _table(loads: Sequence[BusLoad]) -> Table:
    from workbench.report.layout import table

    out = table("bus", ("motors", "right"), ("frames/s", "right"), ("worst load", "right"))
    for each in loads:
        share = f"{100 * each.share:.0f} %"
        out.add_row(each.bus, str(each.motors), f"{each.frames:.0f}", share if each.fits else f"{share} !")
    return out


@can.command()
def dbc(
    config: ConfigArgument,
    output: Annotated[str, typer.Option("--output", "-o", metavar="FILE", help="The DBC file.")],
    force: ForceOption = False,
) -> None:
    """Write a DBC of the drives, so that other tools can read the logs.

    Example: workbench can dbc robot.toml -o robot.dbc
    """
    from workbench.can import dbc as text
    from workbench.can import load_config, make_drive
    from workbench.core.files import write_whole

    motors = load_config(config).motor
    write_whole(output, text({motor.axis: make_drive(motor) for motor in motors}), force=force)
