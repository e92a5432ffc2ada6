"""Arguments and options that several commands take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option

from workbench.core import InputError
from workbench.core.files import saying

from . import complete
from .heartbeat import begin


def placed(path: str | None) -> str | None:
    """Return the path of an output.

    A new folder is made for an output; one above it that does not exist is a typing error.

    Raises:
        InputError: the folder that would hold the new folder does not exist.
    """
    if path and path != "-":
        above = Path(path).parent.parent
        with saying(path):
            there = above.is_dir()
        if not there:
            raise InputError(
                f"there is no folder '{above}'", file=path, remedy="make it, or correct the path"
            )
    return path


def written(*names: str, format_: str = "", **more: Any) -> Any:
    """Return the option of an output, refused before anything is computed if it cannot be written.

    Args:
        names: as ``"--output", "-o"``; none: as the parameter is called.
        format_: a kind of result whose library may be missing.
        more: as `typer.Option`.
    """

    def checked(path: str | None) -> str | None:
        path = placed(path)
        if path and format_:
            from workbench import report

            getattr(report, f"check_{format_}")(path)
        return path

    return Option(*names, callback=checked, **more)


Model = Annotated[
    str,
    Argument(
        metavar="MODEL",
        help="Model file (.toml, .xml, .urdf), a shipped model's name, or robot_descriptions:NAME.",
        autocompletion=complete.models,
    ),
]
Recordings = Annotated[list[str], Argument(metavar="REC...", help="Recording files (.toml).")]
Holdout = Annotated[
    list[str] | None,
    Option("--holdout", metavar="REC", help="Recording that only tests the fit; may be given several times."),
]
Json = Annotated[
    str | None, written("--json", metavar="FILE", help="Write the result as JSON; - for standard output.")
]
Html = Annotated[
    str | None, written("--html", metavar="FILE", help="Write the result as a self-contained page.")
]
Mcap = Annotated[
    str | None,
    written(
        "--mcap",
        format_="mcap",
        metavar="FILE",
        help="Write measured and simulated signals for Foxglove and PlotJuggler.",
    ),
]
Rerun = Annotated[
    str | None,
    written(
        "--rerun",
        format_="rerun",
        metavar="FILE",
        help="Write measured and simulated signals as .rrd for the Rerun viewer.",
    ),
]
Whole = Annotated[bool, Option("--whole", help="Fit every row of long logs, however much memory that takes.")]
Force = Annotated[bool, Option("--force", help="Overwrite existing outputs.")]
Seed = Annotated[int, Option("--seed", min=0, help="Seed of the noise simulations.")]
Quiet = Annotated[
    bool, Option("--quiet", "-q", callback=begin, is_eager=True, help="Print nothing but errors.")
]
