"""Pictures of marks: which effect is taken for which, whether probabilities hold, time against accuracy.

python exam/pictures.py answers/* -o pictures              # after `workbench-exam score`; needs matplotlib
python exam/pictures.py exam/open-marks.jsonl -o pictures  # those of the page
"""

from __future__ import annotations

import argparse
import math
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from workbench_exam.reading import read_json
from workbench_exam.scoring import wilson
from workbench_exam.table import Marks, read_lines, reliability, row

_BLUE, _GREY, _ORANGE = "#0072b2", "#777777", "#d55e00"  # Okabe and Ito's, told apart by all eyes


def main() -> None:
    """Draws all three."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("marks", type=Path, nargs="+", help="folders with marks.json, or files of lines")
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--confusion", nargs="*", help="solvers to show there; default: all")
    parser.add_argument("--first", type=int, help="only so many cases of each solver")
    arguments = parser.parse_args()
    solvers: dict[str, Marks] = {}
    for given in arguments.marks:
        if given.is_dir():
            solvers[given.name] = read_json(given / "marks.json")
        else:
            solvers |= read_lines(given)
    solvers = {name: marks[: arguments.first] for name, marks in solvers.items()}
    shown = {name: solvers[name] for name in arguments.confusion or solvers}
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name, figure in (
        ("confusion", confusion(shown)),
        ("calibration", calibration(solvers)),
        ("time", time_against_accuracy(solvers)),
    ):
        figure.savefig(arguments.out / f"{name}.png", dpi=110)


def pairs(marks: Marks) -> Counter[tuple[str, str]]:
    """How often a hidden effect (or ``nothing``) was named as another (or as ``nothing``)."""
    found: Counter[tuple[str, str]] = Counter()
    for m in marks:
        false = [n["effect"] for n in m["named"] if n["is"] == "false"] + [
            o.split("@")[0] for o in m["outside"]
        ]
        missed = [effect for effect, _ in m["missed"]]
        found.update((n["effect"], n["effect"]) for n in m["named"] if n["is"] != "false")
        for k in range(max(len(missed), len(false))):
            found[missed[k] if k < len(missed) else "nothing", false[k] if k < len(false) else "nothing"] += 1
    return found


def confusion(solvers: Mapping[str, Marks]) -> Figure:
    """A matrix a solver: rows are hidden, columns named."""
    counted = {name: pairs(marks) for name, marks in solvers.items()}
    names = [*sorted({n for c in counted.values() for pair in c for n in pair} - {"nothing"}), "nothing"]
    figure, axes = plt.subplots(
        1, len(counted), figsize=(1.5 + 5.4 * len(counted), 6.6), layout="constrained", squeeze=False
    )
    for ax, (name, found) in zip(axes[0], counted.items(), strict=True):
        for (hidden, said), count in found.items():
            y, x = names.index(hidden), names.index(said)
            ax.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, color=_BLUE if x == y else _ORANGE, alpha=0.35))
            ax.text(x, y, str(count), ha="center", va="center")
        ax.set(
            xlim=(-0.5, len(names) - 0.5),
            ylim=(len(names) - 0.5, -0.5),
            title=f"{name}, {len(solvers[name])} cases",
        )
        words = [n.replace("_", " ") for n in names]
        ax.set_xticks(range(len(names)), words, rotation=90)
        ax.set_yticks(range(len(names)), words if ax is axes[0][0] else [])
        ax.set_xlabel("named")
        ax.grid(color="#eeeeee")
        ax.set_axisbelow(True)
    axes[0][0].set_ylabel("hidden")
    return figure


def calibration(solvers: Mapping[str, Marks]) -> Figure:
    """Share of names that are right over the probability stated, with 95 % intervals."""
    figure, ax = plt.subplots(figsize=(5.2, 4.4), layout="constrained")
    ax.plot([0, 1], [0, 1], color=_GREY, lw=1, label="as stated")
    for name, marks in solvers.items():
        for k, (stated, right, of) in enumerate(reliability(marks)):
            low, high = wilson(right, of)
            ax.plot([stated, stated], [low, high], color=_BLUE, lw=1)
            ax.plot(stated, right / of, "o", color=_BLUE, label=name if k == 0 else None)
            ax.annotate(
                f"{right} of {of}",
                (stated, right / of),
                xytext=(-6, -4),
                textcoords="offset points",
                ha="right",
            )
    ax.set(
        xlim=(0, 1.02), ylim=(0, 1.02), xlabel="probability stated", ylabel="share of names that are right"
    )
    ax.legend(loc="upper left", frameon=False)
    return figure


def time_against_accuracy(solvers: Mapping[str, Marks]) -> Figure:
    """Share of cases that are right, with 95 % intervals, over the median processor time of a case."""
    figure, ax = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
    figured = {name: row(marks) for name, marks in solvers.items()}
    timed = {name: figures for name, figures in figured.items() if math.isfinite(figures["seconds"])}
    places = {name: (max(f["seconds"], 1e-2), f["right"][0] / f["right"][1]) for name, f in timed.items()}
    for name, figures in timed.items():
        good, of = figures["right"]
        low, high = wilson(good, of)
        at, share = places[name]
        # of neighbours the name of the lower one stands below its point
        below = any(0.5 < at / x < 2.0 and share < y for x, y in places.values())
        ax.plot([at, at], [low, high], color=_GREY, lw=1)
        ax.plot(at, good / of, "o", color=_BLUE)
        beside = (6, -12) if below else (6, 4)
        ax.annotate(f"{name} ({of})", (at, good / of), xytext=beside, textcoords="offset points", fontsize=9)
    ax.set(
        xscale="log", ylim=(-0.08, 1.08), xlabel="median processor time of a case [s]", ylabel="cases right"
    )
    ax.margins(x=0.25)
    return figure


if __name__ == "__main__":
    main()
