"""Two pictures of the measured machines: errors over the noise before and after, values beside known ones."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib.pyplot as plt
import numpy as np
from machine_table import Answer, Row, machines, ratio, rows
from matplotlib.figure import Figure

from workbench.core.palette import COLOURS
from workbench.report.numbers import Z95
from workbench.report.wording import effect_name

_NARROW = 8.5  # inches


def figures(answers: Mapping[str, Answer]) -> dict[str, Figure]:
    """File name to picture."""
    return {
        "real-machines.png": error_figure(answers),
        "real-machines-values.png": value_figure(answers),
    }


def error_figure(answers: Mapping[str, Answer]) -> Figure:
    """A line a machine: error over noise as given and with what is named, on data that were not fitted."""
    shown = [m for m in machines() if m["name"] in answers]
    figure, ax = plt.subplots(figsize=(_NARROW, 0.42 * len(shown) + 1.2), layout="constrained")
    for y, machine in enumerate(shown):
        answer = answers[machine["name"]]
        before, after = (ratio(answer, when) for when in ("before", "after"))
        ax.plot([before, after], [y, y], color=_light("measured"), lw=1.5, zorder=1)
        ax.plot(before, y, "o", ms=8, mfc="white", mec=_light("before"), mew=1.8)
        if "failed" in answer:
            ax.annotate("no answer", (before, y), (9, 0), textcoords="offset points", va="center", fontsize=8)
        else:
            ax.plot(after, y, "o", ms=5.5, color=_light("after"))
    ax.axvline(1.0, color=_light("noise"), ls="--", lw=1.2)
    ax.plot([], [], "o", ms=8, mfc="white", mec=_light("before"), mew=1.8, label="model as given")
    ax.plot([], [], "o", ms=5.5, color=_light("after"), label="with the named effects")
    ax.plot([], [], color=_light("noise"), ls="--", label="noise floor: a perfect model")
    ax.set(xscale="log", xlabel="error divided by the noise floor, on data that were not fitted")
    ax.set_yticks(range(len(shown)), [m["title"] for m in shown])
    ax.invert_yaxis()
    ax.grid(axis="x", color=_light("rule"))
    ax.legend(loc="upper center", bbox_to_anchor=(0.2, -0.12), ncols=3, frameon=False, columnspacing=1.2)
    return figure


def value_figure(answers: Mapping[str, Answer]) -> Figure:
    """What was said over each value that is known, with its 95 % interval; not named: at the edge."""
    wanted = {
        m["title"]: [r for r in rows(m, answers[m["name"]]) if r.known is not None]
        for m in machines()
        if m["name"] in answers and "failed" not in answers[m["name"]]
    }
    shown = {title: found for title, found in wanted.items() if found}
    heights = [len(found) + 1.5 for found in shown.values()]
    figure, axes = plt.subplots(
        max(1, len(shown)), 1, figsize=(_NARROW, 0.24 * sum(heights) + 0.8), layout="constrained",
        sharex=True, height_ratios=heights or None, squeeze=False,
    )  # fmt: skip
    for ax, (title, found) in zip(axes[:, 0], shown.items(), strict=False):
        for y, row in enumerate(found):
            if row.found is None or row.known is None:
                ax.plot(0.0, y, "x", color=_light("before"), ms=7, mew=1.8, clip_on=False)
                continue
            value, half = (k / row.known for k in (row.found["value"], Z95 * row.found["std"]))
            colour = _light("before" if row.state == "outside" else "after")
            ax.errorbar(min(value, 2.95), y, xerr=half, fmt="o", ms=4.5, color=colour, capsize=2.5, lw=1.3)
        ax.axvline(1.0, color=_light("noise"), ls="--", lw=1.2)
        ax.set_yticks(range(len(found)), [_label(r) for r in found], fontsize=8)
        ax.set(xlim=(0.0, 3.0), ylim=(len(found) - 0.4, -0.6))
        ax.set_title(title, fontsize=10, loc="left")
        ax.grid(axis="x", color=_light("rule"))
    legend = "✕ at 0: not named;  orange: outside the tolerance"
    axes[-1, 0].set(xlabel=f"found divided by known value, with 95 % interval\n{legend}")
    axes[-1, 0].set_xticks(np.arange(0.0, 3.1, 0.5))
    return figure


def _label(row: Row) -> str:
    words = effect_name(row.what) if row.parameter else row.what.replace("_hz", "").replace("_", " ")
    several = row.what in ("asymmetric_friction", "cogging")
    number = row.parameter.replace("_", " ") if several else ""
    return " ".join(w for w in (row.axis or "", words, number) if w)


def _light(colour: str) -> str:
    return COLOURS[colour][0]
