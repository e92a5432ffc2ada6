"""The program: its commands, and how errors end."""

from __future__ import annotations

import os
import sys
from importlib import metadata
from typing import Annotated

import typer

from .listing import Listing

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
        print(f"workbench {metadata.version('workbench')}")
        raise typer.Exit


@app.callback()
def _program(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Show the version and exit."),
    ] = False,
) -> None: ...


def run() -> None:
    """Run the command line; a `WorkbenchError` ends in one line and its exit code."""
    # many small factorisations: the threads of a linear algebra library only get in each other's way
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    # nothing is drawn by MuJoCo here, which would load a window library and start a process to look at it
    os.environ.setdefault("MUJOCO_GL", "disable")
    # python-can loads it, if it is there, to read MF4: a second and more, and we read that in another process
    sys.modules.setdefault("asammdf", None)  # pyright: ignore[reportArgumentType]
    from workbench.core import WorkbenchError

    load_commands()
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


def load_commands() -> None:
    """Register every command; each imports what it works with only when it runs."""
    from . import (  # noqa: F401
        add,
        approve,
        can,
        check,
        compare,
        demo,
        deploy,
        diagnose,
        evaluate,
        excite,
        export,
        fleet,
        frf,
        identify,
        import_,
        improve,
        inspect,
        normalize,
        record,
        show,
        train,
        ui,
    )
