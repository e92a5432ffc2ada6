"""The learning curve on the disk, and as a picture; needs no torch."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from workbench.core.files import write_whole
from workbench.core.palette import COLOURS

FILE = "curve.csv"
_ORDER = "after", "before", "good", "fifth", "accent", "measured"


def read_curve(folder: Path) -> list[dict[str, float]]:
    """Return the rows of the learning curve of a run; empty without a file."""
    file = folder / FILE
    if not file.exists():
        return []
    with file.open(encoding="utf-8") as stream:
        return [{k: float(v) for k, v in row.items() if v} for row in csv.DictReader(stream)]


def draw(file: Path, rows: Sequence[Mapping[str, float]]) -> None:
    """Draw reward, length of episodes and terms of the reward over iterations, as PNG."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 8.0), layout="constrained")
    plots = figure.subplots(3, 1, sharex=True)
    over = [row["iteration"] for row in rows]
    terms = sorted({name for row in rows for name in row if name.startswith("term_")})
    for plot, names, label in zip(
        plots,
        (["reward"], ["episode_s"], terms),
        ("reward per second", "episode [s]", "terms per second"),
        strict=True,
    ):
        for k, name in enumerate(names):
            dash = "-" if k < len(_ORDER) else "--"
            values = [row.get(name, np.nan) for row in rows]
            colour = COLOURS[_ORDER[k % len(_ORDER)]][0]
            plot.plot(over, values, dash, color=colour, lw=1.3, label=name.removeprefix("term_"))
        plot.set_ylabel(label)
        plot.grid(True, color=COLOURS["rule"][0])
    if terms:
        plots[2].legend(fontsize=7, ncols=3)
    plots[2].set_xlabel("iteration")
    made = io.BytesIO()
    figure.savefig(made, format="png", dpi=110)
    write_whole(file, made.getvalue(), force=True)
