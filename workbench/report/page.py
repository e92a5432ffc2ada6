"""One self-contained page: a result that anybody can open from disk, without a network, years later."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from workbench.core import Comparison, Diagnosis, Improvement, Result
from workbench.core.files import check_free, write_whole

from .figures import overlay_figure
from .json import Truth
from .numbers import plain
from .pack import comparisons, plots, worst_view
from .residual_strip import residual_strips
from .residuals import worst_window
from .sections import sections
from .shapes import shape_figure
from .shell import plotly, reproduce, template
from .style import embedded


def write_page(
    result: Result,
    path: str | Path,
    *,
    command: str,
    seeds: Mapping[str, int] | None = None,
    inputs: Sequence[str | Path] = (),
    truth: Truth | None = None,
    force: bool = False,
) -> Path:
    """Write `result` as one HTML page, complete or not at all.

    Args:
        result: what to show.
        path: the page's file.
        command: the command line that reproduces it.
        seeds: name to seed of everything random on the way.
        inputs: the files that went in; their SHA-256 is printed.
        truth: what the virtual hardware hid (see `truth_rows`), shown beside the answer.
        force: overwrite a file that is there already.

    Raises:
        InputError: the file exists and `force` is false, or an input cannot be read.
    """
    check_free(path, force=force)
    page = render_page(result, command=command, seeds=seeds, inputs=inputs, truth=truth)
    return write_whole(path, page, force=force)


def render_page(
    result: Result,
    *,
    command: str,
    seeds: Mapping[str, int] | None = None,
    inputs: Sequence[str | Path] = (),
    truth: Truth | None = None,
) -> str:
    """Return the page as HTML text; see `write_page`."""
    before, after = comparisons(result)
    values, curves, fallback = None, "", None
    parts = sections(result, before, after, truth)
    if before is not None and before.recordings and before.axes:
        values, curves = plots(before, after)
        values["shapes"] = parts["shapes"]
        fallback = _fallback(before, after)
    return template("page.html.j2").render(
        **parts,
        reproduce=reproduce(command, seeds, inputs),
        plots=values,
        curves=curves,
        plotly=plotly() if values else "",
        fallback=fallback,
        strips=residual_strips(before, after),
        shape_picture=_shape_picture(result) if parts["shapes"] else "",
    )


def _fallback(before: Comparison, after: Comparison | None) -> dict[str, str]:
    """The main figure as a picture, for where scripts do not run: where the model fails most."""
    index, axis = worst_view(before)
    figure = overlay_figure(
        before, axis, recording=index, after=after, window=worst_window(before.recordings[index], axis)
    )
    return {
        "picture": embedded(figure),
        "axis": plain(axis),
        "recording": plain(before.recordings[index].recording.name),
    }


def _shape_picture(result: Result) -> str:
    diagnosis = result.diagnosis if isinstance(result, Improvement) else result
    return embedded(shape_figure(diagnosis)) if isinstance(diagnosis, Diagnosis) else ""
