"""Figures that the demonstration leaves behind."""

from __future__ import annotations

from pathlib import Path

from workbench.core import Improvement


def draw_figures(result: Improvement, folder: Path, *, force: bool) -> None:
    """Error falling, residuals and spectra before and after, and curves over curves, as PNG."""
    from workbench import report

    if result.before is None:
        return
    report.save_figure(report.ladder_figure(result), folder / "error_falling.png", force=force)
    after = result.after if result.steps else None
    worst = result.steps[0].key.axis if result.steps else None
    axis = worst or result.before.axes[0]
    for name, draw in (
        ("overlay", report.overlay_figure),
        ("residual", report.residual_figure),
        ("spectrum", report.spectrum_figure),
    ):
        report.save_figure(draw(result.before, axis, after=after), folder / f"{name}_{axis}.png", force=force)
