"""``workbench ui``."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from workbench.core import InputError

from . import complete, options
from .common import echo


def ui(
    model: Annotated[
        str | None,
        Argument(
            metavar="[MODEL]",
            help="Model file (.toml, .xml or .urdf), or a shipped model's name.",
            autocompletion=complete.models,
        ),
    ] = None,
    recordings: Annotated[
        list[str] | None, Argument(metavar="[REC...]", help="Recording files (.toml).")
    ] = None,
    holdout: Annotated[str | None, Option(metavar="REC", help="Recording that only tests the fit.")] = None,
    port: Annotated[int, Option(min=0, max=65535, help="Port of the page; 0: any free port.")] = 0,
    browser: Annotated[bool, Option("--browser/--no-browser", help="Open the page in a browser.")] = True,
    seed: options.Seed = 0,
) -> None:
    """Open the live workbench in the browser, on this machine only, until interrupted.

    Without names it offers the models and recordings in this folder. Nothing is written unless asked for.

    Example: workbench ui leg recordings/*.toml --holdout recordings/validation.toml
    """
    if importlib.util.find_spec("panel") is None:
        raise InputError(
            "the live workbench needs Panel", remedy="install it: pip install 'robot-workbench[ui]'"
        )
    from workbench.ui import Bench, Shelf

    names = list(recordings or [])
    if holdout is not None and holdout not in names:
        names.append(holdout)
    shelf = Shelf.of(model, names, Path.cwd())
    bench = Bench(shelf, Path.cwd(), seed)
    first, labels = next(iter(shelf.models)), list(shelf.recordings)[: len(names)]
    if model is not None and names:
        bench.choose(bench.read(first, labels, None if holdout is None else labels[names.index(holdout)]))
    elif model is not None:
        shelf.model(first)

    from workbench.ui.server import serve

    def ready(address: str) -> None:
        echo(f"The workbench is at {address}  (Ctrl-C ends it)")
        if browser:
            typer.launch(address)

    serve(bench, port, ready)
