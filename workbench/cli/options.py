"""Arguments and options that several commands take."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from typer import Argument, Option

from . import complete
from .heartbeat import begin


def _can_be_written(format_: str) -> Callable[[str | None], str | None]:
    """Refuses a result whose library is missing before minutes are spent on it."""

    def checked(path: str | None) -> str | None:
        if path is not None:
            from workbench import report

            getattr(report, f"check_{format_}")(path)
        return path

    return checked


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
    str | None, Option("--json", metavar="FILE", help="Write the result as JSON; - for standard output.")
]
Html = Annotated[
    str | None, Option("--html", metavar="FILE", help="Write the result as a self-contained page.")
]
Mcap = Annotated[
    str | None,
    Option(
        "--mcap",
        metavar="FILE",
        callback=_can_be_written("mcap"),
        help="Write measured and simulated signals for Foxglove and PlotJuggler.",
    ),
]
Rerun = Annotated[
    str | None,
    Option(
        "--rerun",
        metavar="FILE",
        callback=_can_be_written("rerun"),
        help="Write measured and simulated signals as .rrd for the Rerun viewer.",
    ),
]
Whole = Annotated[bool, Option("--whole", help="Fit every row of long logs, however much memory that takes.")]
Force = Annotated[bool, Option("--force", help="Overwrite existing outputs.")]
Seed = Annotated[int, Option("--seed", min=0, help="Seed of the noise simulations.")]
Quiet = Annotated[
    bool, Option("--quiet", "-q", callback=begin, is_eager=True, help="Print nothing but errors.")
]
