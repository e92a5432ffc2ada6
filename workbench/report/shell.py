"""What every page has: the template around it, plotly in it, and how to reproduce what it shows."""

from __future__ import annotations

import base64
import gzip
import hashlib
import platform
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import metadata, resources
from pathlib import Path
from typing import Any

import jinja2

from workbench.core import InputError
from workbench.core.palette import COLOURS

from .numbers import plain, unbroken

_PACKAGES = ("workbench", "numpy", "scipy", "drake", "mujoco", "pin", "plotly")


def reproduce(command: str, seeds: Mapping[str, int] | None, inputs: Sequence[str | Path]) -> dict[str, Any]:
    """Command, seeds, versions and the inputs' SHA-256, as the template prints them.

    Raises:
        InputError: an input cannot be read.
    """
    return {
        "command": plain(command),
        "seeds": [(plain(k), v) for k, v in (seeds or {}).items()],
        "versions": _versions(),
        "inputs": [(plain(p), _sha256(Path(p))) for p in inputs],
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


def _versions() -> list[tuple[str, str]]:
    out = [("python", platform.python_version())]
    for name in _PACKAGES:
        try:
            out.append((name, metadata.version(name)))
        except metadata.PackageNotFoundError:
            continue
    return out


def _sha256(path: Path) -> str:
    try:
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"cannot read: {error.strerror or error}", file=path) from error
