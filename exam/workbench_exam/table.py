"""Many marks as one table: a row a solver."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

from .scoring import wilson

Marks = Sequence[Mapping[str, Any]]
_HEAD = (
    "solver", "cases right", "effects named", "false names", "nothing named where nothing is",
    "strangers left alone", "Brier", "intervals that hold", "error removed", "processor s per case",
)  # fmt: skip
BINS = (0.0, 0.5, 0.8, 0.95, 1.0 + 1e-9)


def row(marks: Marks) -> dict[str, Any]:
    """The figures of one solver: counts as (good, of), others as numbers or None."""
    named = [n for m in marks for n in m["named"]]
    sure = [(n["probability"], n["is"] != "false") for n in named if n["probability"] is not None]
    held = [h for n in named for h in n["covered"].values()]
    removed = [m["removed"] for m in marks if m["removed"] is not None]
    clean = [m for m in marks if m["kind"] in ("clean", "disagree")]
    strange = [m for m in marks if m["kind"] == "stranger"]
    asked = sum(m["asked"] for m in marks)
    return {
        "right": (sum(m["good"] for m in marks), len(marks)),
        "named": (asked - sum(len(m["missed"]) for m in marks), asked),
        "false": sum(m["false"] for m in marks),
        "clean": (sum(m["abstained"] for m in clean), len(clean)),
        "strangers": (sum(m["abstained"] for m in strange), len(strange)),
        "brier": sum((p - right) ** 2 for p, right in sure) / len(sure) if sure else None,
        "sure": len(sure),
        "held": (sum(held), len(held)),
        "removed": median(removed) if removed else None,
        "seconds": median(m["processor_seconds"] for m in marks) if _timed(marks) else math.nan,
        "failed": sum("failed" in m for m in marks),
    }


def _timed(marks: Marks) -> bool:
    """Whether each answer says what processor time it took; other clocks go on while a solver waits."""
    return all("processor_seconds" in m for m in marks)


def reliability(marks: Marks) -> list[tuple[float, int, int]]:
    """Mean probability, right names and all names of each bin of probability that has any."""
    sure = [
        (n["probability"], n["is"] != "false")
        for m in marks
        for n in m["named"]
        if n["probability"] is not None
    ]
    bins = [[s for s in sure if low <= s[0] < high] for low, high in pairwise(BINS)]
    return [(sum(p for p, _ in b) / len(b), sum(r for _, r in b), len(b)) for b in bins if b]


def lines_of(solvers: Mapping[str, Marks]) -> str:
    """JSON Lines: one line per solver and case."""
    return "".join(
        json.dumps({"solver": name, **each}) + "\n" for name, marks in solvers.items() for each in marks
    )


def read_lines(file: Path) -> dict[str, list[dict[str, Any]]]:
    """Solver -> its marks, from such lines.

    Raises:
        ValueError: a line that is no mark, with its number.
    """
    solvers: dict[str, list[dict[str, Any]]] = {}
    for number, line in enumerate(file.read_text("utf-8").splitlines(), 1):
        try:
            each = json.loads(line)
            solvers.setdefault(each.pop("solver"), []).append(each)
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"{file}:{number}: no mark of a solver; `score --lines` writes them") from error
    return solvers


def table(solvers: Mapping[str, Marks]) -> str:
    """A Markdown table; shares with their 95 % intervals. It says who answered fewer cases than others."""
    most = max(map(len, solvers.values()), default=0)
    lines = ["| " + " | ".join(_HEAD) + " |", "|" + "---|" * len(_HEAD)]
    for name, marks in solvers.items():
        r = row(marks)
        brier = "-" if r["brier"] is None else f"{r['brier']:.3f} ({r['sure']})"
        removed = "-" if r["removed"] is None else f"{r['removed']:.2f}"
        said = [f"{r['failed']} failed"] if r["failed"] else []
        said += [f"answered {len(marks)}"] if len(marks) < most else []
        cells = [
            name + (f" ({', '.join(said)})" if said else ""), _share(r["right"], True),
            _share(r["named"], True), str(r["false"]), _share(r["clean"]), _share(r["strangers"]), brier,
            _share(r["held"]), removed, f"{r['seconds']:.3g}" if math.isfinite(r["seconds"]) else "-",
        ]  # fmt: skip
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _share(counts: tuple[int, int], interval: bool = False) -> str:
    good, of = counts
    if not of:
        return "-"
    low, high = wilson(good, of)
    return f"{good} of {of}" + (f" ({low:.0%} to {high:.0%})" if interval else "")
