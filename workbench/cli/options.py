"""Arguments and options that several commands take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from typer import Argument, Option

from workbench.core import InputError
from workbench.core.files import check_place, saying

from . import complete
from .heartbeat import begin


def placed(path: str) -> str:
    """Return the path of an output, if it can be written.

    A new folder is made for an output; one above it that does not exist is a typing error.

    Raises:
        InputError: the folder that would hold the new folder does not exist, or cannot be written.
    """
    above = Path(path).parent.parent
    with saying(path):
        there = above.is_dir()
    if not there:
        raise InputError(f"there is no folder '{above}'", file=path, remedy="make it, or correct the path")
    check_place(path)
    return path


def placed_folder(path: str) -> str:
    """Return the path of a folder of outputs, if files can be written in it; as `placed`."""
    placed(path)
    check_place(Path(path) / "any")
    return path


def check_ending(path: str, ending: str) -> None:
    """Refuse an output that could not be read again under its name.

    Raises:
        InputError: its name does not have this ending; an empty one is every name's.
    """
    if not path.endswith(ending):
        raise InputError(f"does not end in {ending}", file=path, remedy=f"name it {ending}")


def written(*names: str, format_: str = "", ending: str = "", folder: bool = False, **more: Any) -> Any:
    """Return the option of an output, refused before anything is computed if it cannot be written.

    Args:
        names: as ``"--output", "-o"``; none: as the parameter is called.
        format_: a kind of result that not every name or computer allows: ``report.check_FORMAT`` knows.
        ending: of its name, where only one can be read again.
        folder: whether it is a folder of files.
        more: as `typer.Option`.
    """

    def checked(context: typer.Context, path: str | None) -> str | None:
        if not path or path == "-" or context.resilient_parsing:
            return path
        if folder:
            return placed_folder(path)
        _once(context, placed(path))
        check_ending(path, ending)
        if format_:
            from workbench import report

            getattr(report, f"check_{format_}")(path)
        return path

    return Option(*names, callback=checked, **more)


def _once(context: typer.Context, path: str) -> None:
    """Refuse a file that two options of a command name.

    Raises:
        InputError: it is one.
    """
    outputs: set[Path] = context.meta.setdefault("outputs", set())
    if Path(path).resolve() in outputs:
        raise InputError("two outputs have this name", file=path, remedy="give each its own")
    outputs.add(Path(path).resolve())


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
