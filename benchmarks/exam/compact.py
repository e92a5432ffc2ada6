"""Marks as one short line a case, to be committed.

A line has the case, the code's revision, verdict and outcome, whether that is good, the names with their
values and intervals, the work in simulated steps, and the processor time. A measured machine is a case too:
`machine_line`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

Line = Mapping[str, Any]


def compact(line: Line) -> dict[str, Any]:
    """The short line of a case's marks as `exam.mark` gives them."""
    if "failed" in line:
        return {"case": line["case"], "rev": line["revision"], "failed": _first_line(line["failed"])}
    short: dict[str, Any] = {
        "case": line["case"],
        "rev": line["revision"],
        "verdict": line["verdict"],
        "outcome": line["outcome"],
        "good": line["good"],
        "visible": line["visible"],
        "hidden": [_key(t) for t in line["truth"]],
        "named": [
            {
                "key": f["key"],
                "is": f["is"],
                "p": _round(f["probability"], 3),
                "values": {
                    name: [_round(p["value"]), _round(1.96 * p["std"], 3), p["covered"]]
                    for name, p in f["parameters"].items()
                },
            }
            for f in line["findings"]
        ],
    }
    spent = {"work": _round(line.get("work"), 4), "cpu_s": _round(line["cpu_s"], 3)}
    return short | {"moves": line.get("moves", [])} | spent


def machine_line(answer: Line) -> dict[str, Any]:
    """The short line of a measured machine, of an answer in real-machines.json."""
    name = f"machine-{answer['machine']}"
    if "failed" in answer:
        return {"case": name, "failed": _first_line(answer["failed"])}
    marks = answer["marks"]
    return {
        "case": name,
        "verdict": answer["verdict"],
        "marks": {key: marks[key] for key in ("named", "outside", "false", "right")},
        "error": _round(marks["after"], 4),
        "named": [
            {
                "key": _key(f),
                "p": _round(f["probability"], 3),
                "values": {
                    k: [_round(p["value"]), _round(1.96 * p["std"], 3), None]
                    for k, p in f["parameters"].items()
                },
            }
            for f in answer["findings"]
        ],
        "work": _round(answer.get("work"), 4),
        "cpu_s": _round(answer["seconds"], 3),
    }


def write(lines: Sequence[Line], order: Sequence[str], file: Path) -> None:
    """One line a case; those of the file that are not given anew stay as they are.

    Args:
        lines: short lines.
        order: of the cases; others come after them.
        file: to write.
    """
    kept = {line["case"]: line for line in (read(file) if file.exists() else [])}
    kept |= {line["case"]: line for line in lines}
    place = {case: number for number, case in enumerate(order)}
    lines = sorted(kept.values(), key=lambda line: place.get(line["case"], len(place)))
    file.write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")


def read(file: Path) -> list[dict[str, Any]]:
    """The lines of a compact file."""
    return [json.loads(text) for text in file.read_text(encoding="utf-8").splitlines() if text.strip()]


def _first_line(text: str) -> str:
    return text.splitlines()[0][:120]


def _key(of: Line) -> str:
    place = f"{of['effect']}@{of['axis']}" if of["axis"] else of["effect"]
    return place if of["location"] == "actuator" else f"{place}({of['location']})"


def _round(value: float | None, digits: int = 5) -> float | None:
    return None if value is None else float(f"{value:.{digits}g}")
