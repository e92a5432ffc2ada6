"""The picture of a question: every measure's gap in every simulator, as a share of Kin-Only's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from transfer_looks import LOOKS
from transfer_paired import Spread
from transfer_policies import SIMULATORS

from workbench import report
from workbench.core.palette import COLOURS

_MARKS = {"kin_only": "s", "s3n_act": "^", "s3n_full": "o", "found": "D"}


def gaps_figure(title: str, values: Mapping[str, Mapping[str, np.ndarray]], names: Sequence[str]) -> Figure:
    """Means and 95 % intervals over the pairs, a row a measure; what is no simulator is the floor, a bar."""
    with report.house_style():
        figure = Figure(figsize=(7.2, 1.1 + 0.34 * len(values)), layout="constrained")
        axes = figure.subplots()
        for row, own in enumerate(values.values()):
            whole = Spread.of(own["kin_only"]).mean / 100.0
            for k, name in enumerate(n for n in names if n in own):
                at = Spread.of(own[name])
                mean, half = at.mean / whole, at.half / whole if np.isfinite(at.half) else 0.0
                if name not in SIMULATORS:
                    axes.barh(row, mean, height=0.8, color=COLOURS["measured"][0], lw=0, zorder=0,
                              label=name if row == 0 else None)  # fmt: skip
                    continue
                look = LOOKS[SIMULATORS[name]].drawn()
                axes.errorbar(
                    mean, row + 0.14 * (k - 1.5), xerr=half, fmt=_MARKS[name], ms=4.5, color=look["color"],
                    label=SIMULATORS[name] if row == 0 else None,
                )  # fmt: skip
        axes.set_yticks(range(len(values)), list(values))
        axes.invert_yaxis()
        axes.set_xlim(left=0.0)
        axes.set_xlabel("gap to the hardware, % of Kin-Only's")
        axes.set_title(title)
        figure.legend(loc="outside lower center", ncols=5)
    return figure
