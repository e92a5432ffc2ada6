"""The inertia that a serial tree leaves out of a parallel leg, as tables and a picture."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from rich.table import Table

from workbench.core.palette import COLOURS, LINES
from workbench.core.picture import Picture
from workbench.models import Model
from workbench.report.layout import table as new_table
from workbench.report.response import words_of
from workbench.s3n.gap import InertiaGap, inertia_gap

_ENTRIES = (("M11", 0, 0), ("M12", 0, 1), ("M22", 1, 1))
_LINES = {name: LINES[name] for name in ("kin_only", "s3n_act", "s3n_full")}


def papers_table(model: Model) -> Table:
    """Total equivalent inertia in serial coordinates at alpha = 90 degrees, and the change from Kin-Only."""
    mass = {name: m[0] for name, m in inertia_gap(model, np.array([np.pi / 2])).mass.items()}
    table = new_table("variant", *((name, "right") for name, _, _ in _ENTRIES))
    table.title = "Inertia at alpha = 90° in kg m² (change from Kin-Only)"
    for name, m in mass.items():
        cells = []
        for _, i, j in _ENTRIES:
            change = 100.0 * (m[i, j] / mass["kin_only"][i, j] - 1.0)
            cells.append(f"{m[i, j]:.5f}" + ("" if name == "kin_only" else f" ({change:+.1f} %)"))
        table.add_row(words_of(name), *cells)
    return table


def terms_table(gap: InertiaGap) -> Table:
    """What is missing over alpha, whose it is, and what that does to the acceleration."""
    columns = ("actuators", "linkage", "actuators' share", "Kin-Only too fast by")
    table = new_table("alpha", *((name, "right") for name in columns))
    table.title = "What is missing from Kin-Only (Frobenius norms in kg m²)"
    actuator = float(np.linalg.norm(gap.actuator))
    for k in range(0, len(gap.alpha), 30):
        linkage = float(np.linalg.norm(gap.linkage[k]))
        table.add_row(
            f"{np.degrees(gap.alpha[k]):.0f}°",
            f"{actuator:.5f}",
            f"{linkage:.5f}",
            f"{100 * gap.actuator_share[k]:.0f} %",
            f"{100 * gap.too_fast[k]:.0f} %",
        )
    b = gap.damping
    table.caption = (
        f"Damping that is missing at every posture: {b[0, 0]:.4f}, {b[0, 1]:.4f}, {b[1, 1]:.4f} N m s/rad."
    )
    return table


def gap_figure(gap: InertiaGap) -> Figure:
    """Entries of the mass matrix over alpha by variant, and how much too fast Kin-Only answers."""
    figure = Picture(figsize=(9.0, 2.9), layout="constrained")
    axes = figure.subplots(1, 4)
    degrees = np.degrees(gap.alpha)
    for ax, (name, i, j) in zip(axes, _ENTRIES, strict=False):
        for variant, line in _LINES.items():
            ax.plot(degrees, gap.mass[variant][:, i, j], label=words_of(variant), **line.drawn())
        ax.set_title(f"{name}, serial [kg m²]", fontsize=9, loc="left")
        low, high = ax.get_ylim()
        ax.set_ylim(min(0.0, low), high)
    axes[0].legend(frameon=False, fontsize=8)
    axes[3].plot(degrees, 100.0 * gap.too_fast, color=COLOURS["ink"][0])
    axes[3].set_title("acceleration too high by [%]", fontsize=9, loc="left")
    axes[3].set_ylim(0.0, 120.0 * gap.too_fast.max())
    for ax in axes:
        ax.set_xlabel("knee angle alpha [deg]")
        ax.set_xticks([0, 60, 120, 180])
        ax.grid(alpha=0.25)
        ax.spines[["top", "right"]].set_visible(False)
    return figure
