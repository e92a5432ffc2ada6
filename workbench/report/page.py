"""One self-contained page: a result that anybody can open from disk, without a network, years later."""

from __future__ import annotations

import base64
import hashlib
import platform
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import metadata, resources
from pathlib import Path

import jinja2

from workbench.core import Comparison, Diagnosis, Improvement, InputError
from workbench.core.files import check_free, write_whole

from .figures import figure_bytes, overlay_figure
from .json import Truth
from .numbers import plain, unbroken
from .pack import compress, plots, worst_view
from .residuals import worst_window
from .sections import sections

_PACKAGES = ("workbench", "numpy", "scipy", "drake", "mujoco", "pin", "plotly")


def write_page(
    result: Comparison | Diagnosis | Improvement,
    path: str | Path,
    *,
    command: str,
    seeds: Mapping[str, int] | None = None,
    inputs: Sequence[str | Path] = (),
    truth: Truth | None = None,
    force: bool = False,
) -> Path:
    """Write `result` as one HTML page, whole or not at all.

    Args:
        result: what to show.
        path: the page's file.
        command: the command line that reproduces it.
        seeds: name to seed of everything random on the way.
        inputs: the files that went in; their SHA-256 is printed.
        truth: what the virtual hardware hid (see `truth_rows`), shown at the end.
        force: overwrite a file that is there already.

    Raises:
        InputError: the file exists and `force` is false, or an input cannot be read.
    """
    check_free(path, force=force)
    page = render_page(result, command=command, seeds=seeds, inputs=inputs, truth=truth)
    return write_whole(path, page, force=force)


def render_page(
    result: Comparison | Diagnosis | Improvement,
    *,
    command: str,
    seeds: Mapping[str, int] | None = None,
    inputs: Sequence[str | Path] = (),
    truth: Truth | None = None,
) -> str:
    """The page as HTML text; see `write_page`."""
    before, after = _comparisons(result)
    values, curves, fallback = None, "", None
    if before is not None and before.recordings and before.axes:
        values, curves = plots(before, after)
        fallback = _fallback(before, after)
    return _template().render(
        **sections(result, before, after, truth),
        reproduce={
            "command": plain(command),
            "seeds": [(plain(k), v) for k, v in (seeds or {}).items()],
            "versions": _versions(),
            "inputs": [(plain(p), _sha256(Path(p))) for p in inputs],
        },
        plots=values,
        curves=curves,
        plotly=_plotly() if values else "",
        fallback=fallback,
    )


def _comparisons(result: Comparison | Diagnosis | Improvement) -> tuple[Comparison | None, Comparison | None]:
    if isinstance(result, Comparison):
        return result, None
    added = result.findings if isinstance(result, Diagnosis) else result.steps
    return result.before, result.after if added else None


def _fallback(before: Comparison, after: Comparison | None) -> dict[str, str]:
    """The main figure as a picture, for where scripts do not run: where the model fails most."""
    index, axis = worst_view(before)
    figure = overlay_figure(
        before, axis, recording=index, after=after, window=worst_window(before.recordings[index], axis)
    )
    picture = base64.b64encode(figure_bytes(figure, "png", dpi=130)).decode("ascii")
    return {
        "picture": picture,
        "axis": plain(axis),
        "recording": plain(before.recordings[index].recording.name),
    }


@cache
def _plotly() -> str:
    from plotly.offline import get_plotlyjs  # slow to import, and only pages need it

    return compress(get_plotlyjs().encode("utf-8"))


@cache
def _template() -> jinja2.Template:
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(_read),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["unbroken"] = unbroken
    return environment.get_template("page.html.j2")


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
