"""Figures of the marks: who was taken for whom, whether probabilities hold, how much error went."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from .scoring import wilson
from .table import calibration_classes

Line = Mapping[str, Any]
_INK, _GREY, _BLUE, _ORANGE = (
    "#222222",
    "#777777",
    "#0072b2",
    "#d55e00",
)  # Okabe and Ito's, told apart by all eyes


def draw_all(lines: Sequence[Line], folder: Path) -> list[Path]:
    """Every figure as PNG into `folder`; returns the files."""
    folder.mkdir(parents=True, exist_ok=True)
    marked = [line for line in lines if "failed" not in line]
    figures = {"confusion": confusion(marked), "reliability": reliability(marked), "removed": removed(marked)}
    files = []
    for name, figure in figures.items():
        files.append(folder / f"{name}.png")
        figure.savefig(files[-1], dpi=150)
        plt.close(figure)
    return files


def confusion(lines: Sequence[Line]) -> Figure:
    """Row: what was hidden; column: what was named first. Single visible effects, outsiders, nothing."""
    shown = [
        line
        for line in lines
        if line["kind"] in ("clean", "outsider") or (line["kind"] == "single" and line["visible"])
    ]
    effects = sorted({t["effect"] for x in shown if x["kind"] == "single" for t in x["truth"]})
    named = sorted({f["effect"] for x in shown for f in x["findings"][:1]} - {*effects})
    outsiders = sorted({x["truth"][0]["effect"] for x in shown if x["kind"] == "outsider"})
    rows = [*effects, *outsiders, "nothing"]
    columns = [*effects, *named, "look-alike", "same, other place", "unexplained", "consistent"]
    counts = np.zeros((len(rows), len(columns)), int)
    for line in shown:
        truth = line["truth"][0] if line["truth"] else None
        row = rows.index(truth["effect"] if truth else "nothing")
        counts[row, columns.index(_answer(line, truth))] += 1
    share = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1)
    figure, ax = plt.subplots(
        figsize=(0.34 * len(columns) + 3.6, 0.27 * len(rows) + 3.2), layout="constrained"
    )
    cells = np.ones((*counts.shape, 3))
    for (row, column), count in np.ndenumerate(counts):
        if count:
            cells[row, column] = _shade(_colour(rows[row], columns[column], effects), share[row, column])
            ink = "white" if cells[row, column] @ [0.3, 0.6, 0.1] < 0.5 else _INK
            ax.text(column, row, str(count), ha="center", va="center", fontsize=8, color=ink)
    ax.imshow(cells, aspect="auto")
    ax.set_xticks(range(len(columns)), [c.replace("_", " ") for c in columns], rotation=90, fontsize=8)
    ax.set_yticks(
        range(len(rows)),
        [f"{r.replace('_', ' ')} ({counts[i].sum()})" for i, r in enumerate(rows)],
        fontsize=8,
    )
    ax.set_xticks(np.arange(len(columns)) - 0.5, minor=True)
    ax.set_yticks(np.arange(len(rows)) - 0.5, minor=True)
    ax.grid(which="minor", color="#dddddd", linewidth=0.5)
    ax.tick_params(which="minor", length=0)
    for edge in (len(effects) - 0.5, len(effects) + len(outsiders) - 0.5):
        ax.axhline(edge, color=_INK, linewidth=1)
    ax.axvline(len(columns) - 4.5, color=_INK, linewidth=1)
    ax.set_xlabel("named first")
    ax.set_ylabel("hidden (cases)")
    ax.set_title("Cases by what was hidden and what was named; shade by share of the row", fontsize=10)
    kinds = {"right": _BLUE, "wrong name": _ORANGE, "no name": _GREY}
    patches = [Patch(color=colour) for colour in kinds.values()]
    figure.legend(patches, list(kinds), ncols=3, loc="lower left", frameon=False)
    return figure


def _colour(hidden: str, answer: str, effects: Sequence[str]) -> str:
    """Blue where that is the right answer, orange where it is a wrong name, grey where there is no name."""
    right = hidden if hidden in effects else "consistent" if hidden == "nothing" else "unexplained"
    if answer in (right, "look-alike"):
        return _BLUE
    return _GREY if answer in ("unexplained", "consistent") else _ORANGE


def _shade(colour: str, share: float) -> np.ndarray:
    """The colour, the paler the smaller its share."""
    strength = 0.35 + 0.65 * share
    return strength * np.array(to_rgb(colour)) + 1.0 - strength


def _answer(line: Line, truth: Mapping[str, Any] | None) -> str:
    if not line["findings"]:
        return line["verdict"]
    first = line["findings"][0]
    if truth and first["effect"] == truth["effect"] and first["is"] == "false":
        return "same, other place"
    return "look-alike" if first["is"] == "look-alike" else first["effect"]


def reliability(lines: Sequence[Line]) -> Figure:
    """Stated probability of findings against the share of them that were true."""
    figure, ax = plt.subplots(figsize=(4.6, 4.2), layout="constrained")
    ax.plot([0, 1], [0, 1], color="#888888", linewidth=1, linestyle="--", label="calibrated")
    for _, stated, true in calibration_classes(lines):
        if not stated:
            continue
        share, (low, high) = sum(true) / len(true), wilson(sum(true), len(true))
        away = np.array([[max(share - low, 0.0)], [max(high - share, 0.0)]])
        ax.errorbar(np.mean(stated), share, away, fmt="o", color=_BLUE, capsize=3, clip_on=False)
        ax.annotate(
            str(len(stated)),
            (float(np.mean(stated)), float(low)),
            (4, -2),
            textcoords="offset points",
            fontsize=8,
        )
    ax.set(xlim=(0, 1.02), ylim=(0, 1.02), xlabel="probability stated", ylabel="share that was true")
    ax.set_title("Findings by stated probability (number; 95 % intervals)", fontsize=10)
    ax.legend(frameon=False, loc="upper left")
    return figure


def removed(lines: Sequence[Line]) -> Figure:
    """Share of the removable held-out error that went, of visible catalogued effects."""
    figure, ax = plt.subplots(figsize=(5.6, 3.4), layout="constrained")
    edges = np.arange(-0.125, 1.15, 0.05)
    shares = [
        [
            float(np.clip(line["removed"], edges[0], edges[-1]))
            for line in lines
            if line["kind"] in kinds and line["visible"] and line["removed"] is not None
        ]
        for kinds in (("single",), ("pair", "triple"))
    ]
    labels = [
        f"{name} ({len(own)})" for name, own in zip(("one effect", "two or three"), shares, strict=True)
    ]
    ax.hist(shares, edges.tolist(), color=[_BLUE, _ORANGE], label=labels)
    ax.axvline(1.0, color=_INK, linewidth=1, linestyle="--")
    ax.set(xlabel="share of removable held-out error removed (1: as the true model)", ylabel="cases")
    ax.legend(frameon=False)
    return figure
