"""The program: its commands, and how errors end."""

from __future__ import annotations

import sys
from typing import Annotated

import typer
from typer import Option

from workbench.core import WorkbenchError
from workbench.core.text import plain
from workbench.core.version import VERSION

from .add import add
from .approve import approve
from .can import can
from .check import check
from .common import whole
from .compare import compare
from .demo import demo
from .deploy import deploy
from .diagnose import diagnose
from .evaluate import evaluate
from .excite import excite
from .export import export
from .fleet import fleet
from .frf import frf
from .identify import identify
from .import_ import import_
from .improve import improve
from .inspect import inspect
from .listing import Listing
from .normalize import normalize
from .record import record
from .show import show
from .train import train
from .ui import ui

app = typer.Typer(
    name="workbench",
    cls=Listing,
    help=(
        "Compare a robot model with measurements, find the physical effect that is missing, add it, "
        "and watch the error fall.\n\nStart with: workbench demo"
    ),
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(asked: bool) -> None:
    if asked:
        print(f"workbench {VERSION}")
        raise typer.Exit


@app.callback()
def _program(
    version: Annotated[
        bool, Option("--version", callback=_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None: ...


for _command in (
    add, approve, check, compare, diagnose, evaluate, excite, frf, inspect, normalize, show,
):  # fmt: skip
    app.command()(whole(_command))
for _command in (demo, deploy, export, fleet, improve, record, train, ui):
    app.command()(_command)
app.command(name="import")(import_)
app.add_typer(can)
app.add_typer(identify)


def run() -> None:
    """Run the command line; a `WorkbenchError` ends in one line and its exit code."""
    try:
        app()
    except WorkbenchError as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
    except MemoryError:
        print("error: not enough memory; give shorter recordings or fewer of them", file=sys.stderr)
        sys.exit(2)
    except BrokenPipeError:
        sys.exit(0)
    except OSError as error:
        if error.filename is None:
            raise
        reason = error.strerror or "cannot be used"
        print(f"error: {plain(str(error.filename))}: {reason}; check the path", file=sys.stderr)
        sys.exit(2)
