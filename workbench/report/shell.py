"""What every page has: the template around it, plotly in it, and how to reproduce what it shows."""

from __future__ import annotations

import base64
import gzip
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2

from workbench.core.palette import COLOURS
from workbench.core.provenance import PACKAGES, digest, versions

from .numbers import plain, unbroken


def reproduce(command: str, seeds: Mapping[str, int] | None, inputs: Sequence[str | Path]) -> dict[str, Any]:
    """Command, seeds, versions and the inputs' SHA-256, as the template prints them.

    Raises:
        InputError: an input cannot be read.
    """
    once: dict[Path, str | Path] = {}
    for path in inputs:
        once.setdefault(Path(path).resolve(), path)
    return {
        "command": plain(command),
        "seeds": [(plain(k), v) for k, v in (seeds or {}).items()],
        "versions": list(versions([*PACKAGES, "plotly"]).items()),
        "inputs": [(plain(p), digest(p)) for p in once.values()],
    }


def compress(data: bytes) -> str:
    """gzip, then base64: what the page inflates when it is opened."""
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode("ascii")


@cache
def plotly() -> str:
    """The library that draws, compressed."""
    from plotly.offline import get_plotlyjs  # slow to import, and only pages need it

    return compress(get_plotlyjs().encode("utf-8"))


@cache
def template(name: str) -> jinja2.Template:
    """A template of this package; whatever it prints is escaped."""
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(_read),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["unbroken"] = unbroken
    environment.globals["palette"] = COLOURS
    return environment.get_template(name)


def _read(name: str) -> str:
    return resources.files("workbench.report").joinpath("templates", name).read_text(encoding="utf-8")
