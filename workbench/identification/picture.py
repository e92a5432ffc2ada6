"""A measured response and the model fitted to it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.palette import COLOURS, LINES
from workbench.frf import Fit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FIT = LINES["fit"].drawn()
_DOTS, _BAND = COLOURS["quiet"][0], COLOURS["rule"][0]


def fit_figure(fit: Fit) -> Figure:
    """Measured response with its 95 % band and the fit, magnitude over phase, one column an entry."""
    from matplotlib.figure import Figure  # slow to import, and only pictures need it

    first = fit.frfs[0]
    rows, columns = first.response.shape[1:]
    figure = Figure(figsize=(3.2 * rows * columns + 0.8, 4.6), layout="constrained")
    axes = figure.subplots(2, rows * columns, sharex=True, squeeze=False)
    for frf, model in zip(fit.frfs, fit.responses, strict=True):
        for k, (i, j) in enumerate(np.ndindex(rows, columns)):
            _entry(
                axes[0, k], axes[1, k], frf.frequency, frf.response[:, i, j], frf.std[:, i, j], model[:, i, j]
            )
            unit = f"{first.outputs[i].unit} / ({first.inputs[j].unit})"
            axes[0, k].set_title(
                f"{first.outputs[i].axis} over {first.inputs[j].axis} [{unit}]", fontsize=9, loc="left"
            )
            axes[1, k].set_xlabel("frequency [Hz]")
    axes[0, 0].set_ylabel("magnitude")
    axes[1, 0].set_ylabel("phase [deg]")
    axes[0, 0].legend(frameon=False, fontsize=8)
    return figure


def _entry(
    magnitude: Any, phase: Any, f: np.ndarray, measured: np.ndarray, std: np.ndarray, model: np.ndarray
) -> None:
    size = np.abs(measured)
    low = np.maximum(size - 1.96 * std, 0.02 * size)
    magnitude.fill_between(f, low, size + 1.96 * std, color=_BAND, lw=0, label="95 %")
    magnitude.loglog(f, size, ".", ms=3, color=_DOTS, label="measured")
    magnitude.loglog(f, np.abs(model), **_FIT, label="fit")
    fitted = np.unwrap(np.angle(model))
    # noise would make an unwrapped measurement jump by whole turns; each line lies within half of one
    beside = fitted + np.angle(measured / model)
    phase.semilogx(f, np.degrees(beside), ".", ms=3, color=_DOTS)
    phase.semilogx(f, np.degrees(fitted), **_FIT)
    for ax in (magnitude, phase):
        ax.grid(alpha=0.25)
        ax.spines[["top", "right"]].set_visible(False)
