"""Where the paper's injected compensation torques ring, and where they diverge.

    python analyses/explicit_stability.py -o out/explicit_stability

Torques computed from the preceding step's acceleration iterate that acceleration: at every step an error is
multiplied by the spectral radius of (M_s + J2 E_h)^-1 (J2 E_x + Delta M_link), however short the step is.
Picture and table show the radius over the knee angle, for the reference leg and for heavier linkages.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from rich.table import Table
from scipy.optimize import brentq

from workbench import load_model, report
from workbench.core import InputError
from workbench.core.files import write_whole
from workbench.models import Model
from workbench.report.layout import table as new_table
from workbench.s3n import explicit_spectral_radius

_ALPHA = np.radians(np.linspace(0.0, 180.0, 181))
_SHOWN = (0, 90, 180)  # degrees, columns of the table
_HEAVIER = (1.0, 1.1, 1.25, 1.5, 2.0)
_COLORS = ("#1a1c1e", "#0072B2", "#009E73", "#E69F00", "#D55E00")
_STYLES = ("-", (0, (4, 1.6)), (0, (1, 1.2)), (0, (6, 1.5, 1, 1.5)), (0, (3, 1)))


def main() -> None:
    """Compute, print, draw, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--model", default="leg")
    parser.add_argument("-o", "--output", type=Path, default=Path("out/explicit_stability"))
    arguments = parser.parse_args()
    model, folder = load_model(arguments.model), arguments.output
    radius = {factor: explicit_spectral_radius(heavier(model, factor), _ALPHA) for factor in _HEAVIER}
    report.print_table(radius_table(radius, critical_factor(model)))
    report.save_figure(radius_figure(radius), folder / "explicit_stability.png", force=True)
    write_whole(folder / "explicit_stability.csv", radius_csv(radius), force=True)
    print(f"Wrote {folder}.")


def heavier(model: Model, factor: float) -> Model:
    """The model with every increment of its linkage's inertia multiplied."""
    link = model.linkage
    if link is None:
        raise InputError(f"model '{model.name}' states no linkage", remedy="give one with a [linkage] table")
    more = replace(link, M11=factor * link.M11, M12=factor * link.M12, M22=factor * link.M22)
    # the linkage's inertia may be an effect of the model already: its table speaks here
    others = tuple(e for e in model.effects if e.key.effect != "linkage_inertia")
    return replace(model, linkage=more, effects=others)


def critical_factor(model: Model) -> float:
    """How many times heavier the linkage may be before the injection diverges at some knee angle."""

    def above(factor: float) -> float:
        return float(explicit_spectral_radius(heavier(model, factor), _ALPHA).max()) - 1.0

    high = 2.0
    while above(high) < 0.0 and high < 1e3:
        high *= 2.0
    return brentq(above, 0.0, high) if above(high) >= 0.0 else float("inf")  # type: ignore[return-value]


def radius_table(radius: dict[float, np.ndarray], critical: float) -> Table:
    """Radius at some angles, how long an error rings, and where it diverges."""
    columns = (*(f"at {a}°" for a in _SHOWN), "steps to 1 %", "diverges at")
    table = new_table("linkage", *((name, "right") for name in columns))
    table.title = "Spectral radius of the injected torques"
    degrees = np.degrees(_ALPHA)
    for factor, r in radius.items():
        bad = degrees[r >= 1.0]
        rings = f"{np.log(0.01) / np.log(r.max()):.0f}" if not bad.size else "never"
        where = f"{bad.min():.0f}° to {bad.max():.0f}°" if bad.size else "none"
        cells = [f"{np.interp(a, degrees, r):.3f}" for a in _SHOWN]
        table.add_row(f"{factor:g} times", *cells, rings, where)
    table.caption = f"It diverges somewhere once the linkage is {critical:.2f} times as heavy."
    return table


def radius_csv(radius: dict[float, np.ndarray]) -> str:
    """The curves as text, one row a degree."""
    lines = [",".join(["alpha_deg", *(f"radius_{factor:g}" for factor in radius)])]
    for k, alpha in enumerate(np.degrees(_ALPHA)):
        lines.append(",".join([f"{alpha:g}", *(f"{r[k]:.6f}" for r in radius.values())]))
    return "\n".join(lines) + "\n"


def radius_figure(radius: dict[float, np.ndarray]) -> Figure:
    """Radius over the knee angle, one line a linkage, and the line that must not be crossed."""
    figure = Figure(figsize=(6.4, 3.1), layout="constrained")
    ax = figure.subplots()
    for (factor, r), color, style in zip(radius.items(), _COLORS, _STYLES, strict=True):
        label = "reference leg" if factor == 1.0 else f"linkage {factor:g} times"
        ax.plot(np.degrees(_ALPHA), r, color=color, ls=style, label=label)
    ax.axhline(1.0, color="#8a9096", lw=0.8, label="diverges above")
    ax.set_xlabel("knee angle alpha [deg]")
    ax.set_ylabel("spectral radius")
    ax.set_title("Injected torques, error from step to step", fontsize=9, loc="left")
    ax.set_xticks([0, 45, 90, 135, 180])
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
    figure.legend(loc="outside right upper", frameon=False, fontsize=8)
    return figure


if __name__ == "__main__":
    main()
