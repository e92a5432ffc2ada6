"""Common parts of every page: its template, plotly, and how to reproduce it."""

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
    """Return command, seeds, versions and the SHA-256 of the inputs, for the template.

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
    """Return the data as gzip in base64; the page decompresses it when it is opened."""
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode("ascii")


@cache
def plotly() -> str:
    """Return the drawing library, compressed."""
    from plotly.offline import get_plotlyjs  # slow to import, and only pages need it

    return compress(get_plotlyjs().encode("utf-8"))


@cache
def template(name: str) -> jinja2.Template:
    """Return a template of this package; what it prints is escaped."""
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
