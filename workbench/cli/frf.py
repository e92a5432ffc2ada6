"""``workbench frf``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from . import options
from .common import check_outputs, files_of, read_recordings, write_result
from .deliver import deliver_sheet
from .progress import progress


def frf(
    model: options.Model,
    recordings: options.Recordings,
    json: options.Json = None,
    html: options.Html = None,
    figure: Annotated[
        str | None,
        options.written(format_="figure", metavar="FILE", help="Picture of the response (.png, .svg, .pdf)."),
    ] = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Estimate frequency responses with uncertainty; compare them with the closed chain and all variants.

    Recordings at different postures are evaluated separately.

    Example: workbench frf leg sum.toml difference.toml --figure frf.png
    """
    from workbench import report
    from workbench.models import read_model
    from workbench.verification import compare_frf, frf_figure, frf_sheet

    from .frf_output import frf_dict, frf_table

    check_outputs(json, html, figure, force=force)
    loaded = read_model(model).on_its_stand("a comparison of responses")
    data = read_recordings(recordings)
    with progress(quiet) as tell:
        tell("estimating responses")
        found = compare_frf(loaded, data)
    if json:
        content: dict[str, Any] = frf_dict(loaded, found)
        write_result(content, json, files=files_of(loaded, data), force=force)
    if html:
        deliver_sheet(frf_sheet(loaded.name, found), html, files=files_of(loaded, data), force=force)
    if figure:
        for place, path in zip(found, _numbered(Path(figure), len(found)), strict=True):
            report.save_figure(frf_figure(place), path, force=force)
    if not quiet and json != "-":
        report.print_table(frf_table(found))


def _numbered(path: Path, count: int) -> list[Path]:
    """One file per posture."""
    return [path] + [path.with_stem(f"{path.stem}_{k}") for k in range(2, count + 1)]
