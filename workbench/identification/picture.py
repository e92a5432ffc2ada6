"""Pictures of what was identified: responses with their fit, and the torque that links leave."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.palette import COLOURS, LINES

from .fit import Fit
from .result import ActuatorIdentification, LinksIdentification

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FIT = LINES["fit"].drawn()
_LOW, _HIGH = LINES["before"].drawn(), LINES["s3n_act"].drawn()
_DOTS, _BAND = COLOURS["quiet"][0], COLOURS["rule"][0]


def fit_figure(fit: Fit) -> Figure:
    """Measured response with its 95 % band and the fit, magnitude over phase, one column an entry."""
    from workbench.core.picture import Picture  # slow to import, and only pictures need it

    first = fit.frfs[0]
    rows, columns = first.response.shape[1:]
    figure = Picture(figsize=(3.2 * rows * columns + 0.8, 4.6), layout="constrained")
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


def actuator_figure(found: ActuatorIdentification) -> Figure:
    """Measured and fitted response of a drive, and what half and twice of each parameter would give.

    One column per parameter, magnitude over phase (as in the paper's figure of the actuator): damping shows
    at low frequency, inertia in the roll-off, the delay in the phase. For a delay of less than a row, one row
    less and one row more are drawn instead.
    """
    from workbench.core.picture import Picture

    frf, fit = found.frf, found.fit
    own = found.inertia.value, found.damping.value, found.delay.value
    row = 1.0 / frf.rate_hz
    delays = (0.5 * own[2], 2.0 * own[2]) if own[2] > row else (own[2] - row, own[2] + row)
    names = ("half", "twice") if own[2] > row else ("a row less", "a row more")
    others = (
        ("damping", ("half", "twice"), [(own[0], f * own[1], own[2]) for f in (0.5, 2.0)]),
        ("inertia", ("half", "twice"), [(f * own[0], own[1], own[2]) for f in (0.5, 2.0)]),
        ("delay", names, [(own[0], own[1], delay) for delay in delays]),
    )
    measured, std, model = frf.response[:, 0, 0], frf.std[:, 0, 0], fit.responses[0][:, 0, 0]
    figure = Picture(figsize=(9.6, 4.6), layout="constrained")
    axes = figure.subplots(2, len(others), sharex=True, sharey="row")
    for k, (name, labels, values) in enumerate(others):
        _entry(axes[0, k], axes[1, k], frf.frequency, measured, std, model)
        for label, look, theta in zip(labels, (_LOW, _HIGH), values, strict=True):
            # the hold of the sampled command is in both, so that a ratio of continuous models will do
            there = model * _drive(frf.frequency, *theta) / _drive(frf.frequency, *own)
            axes[0, k].loglog(frf.frequency, np.abs(there), **look, label=label)
            axes[1, k].semilogx(frf.frequency, np.degrees(np.unwrap(np.angle(there))), **look)
        axes[0, k].set_title(f"other {name}", fontsize=9, loc="left")
        axes[0, k].legend(frameon=False, fontsize=7)
        axes[1, k].set_xlabel("frequency [Hz]")
    out, into = frf.outputs[0], frf.inputs[0]
    axes[0, 0].set_ylabel(f"magnitude [{out.unit} / ({into.unit})]")
    axes[1, 0].set_ylabel("phase [deg]")
    return figure


def links_figure(found: LinksIdentification) -> Figure:
    """Torque that stays on each axis, in units of its noise: as the model is, and with new numbers."""
    from workbench.core.picture import Picture, printed
    from workbench.report.style import house_style

    looks = (
        ("before", "the model as it is", COLOURS["before"][0], "o"),
        ("drives", "with the drives' best friction and damping", COLOURS["quiet"][0], "s"),
        ("after", "with the links' new numbers too", COLOURS["after"][0], "D"),
    )
    rows = np.arange(len(found.torques))
    with house_style():
        figure = Picture(figsize=(7.2, 1.5 + 0.34 * len(rows)), layout="constrained")
        ax = figure.subplots()
        for name, label, colour, marker in looks:
            times = [getattr(t, name) / t.noise for t in found.torques]
            ax.plot(times, rows, marker, color=colour, ms=6, label=label)
        ax.axvline(1.0, color=COLOURS["noise"][0], lw=1.0, ls=(0, (2, 2)), label="noise")
        ax.set_yticks(rows, [printed(t.axis) for t in found.torques])
        ax.invert_yaxis()
        ax.set_xscale("log")
        ax.xaxis.set_major_formatter("{x:g}")
        ax.set_xlabel("torque that stays unexplained, times the noise")
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.35), ncols=2)
    return figure


def _drive(frequency: np.ndarray, inertia: float, damping: float, delay: float) -> np.ndarray:
    s = 2j * np.pi * frequency
    return np.exp(-s * delay) / (inertia * s + damping)


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
