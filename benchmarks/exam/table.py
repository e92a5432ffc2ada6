"""What the marks say, as text: shares with intervals, coverage, calibration, time, and every mistake."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from .cases import KINDS
from .field.cases import KINDS as FIELD
from .scoring import OUTCOMES, wilson

Line = Mapping[str, Any]
#: Edges of the classes of probability.
CLASSES = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 0.975, 1.0)


def tables(lines: Sequence[Line]) -> str:
    """The whole report, in Markdown."""
    marked = [line for line in lines if "failed" not in line]
    names = sorted({name for line in marked for name in line["others"]})
    parts = [
        f"{len(marked)} cases marked, code {', '.join(sorted({str(line['revision']) for line in lines}))}.",
        "## Outcomes",
        outcomes(marked),
        "## Parameters, probability, error, time",
        numbers(marked),
        "## Probability stated, and how often the name was right",
        calibration(marked),
    ]
    for name in names:
        own = [{**line, **line["others"][name]} for line in marked if name in line["others"]]
        answered = [line for line in own if "failed" not in line["others"][name]]
        same = [line for line in marked if name in line["others"] and "failed" not in line["others"][name]]
        parts += [
            f"## {name}, on the {len(answered)} cases that it could be asked",
            outcomes(answered),
            f"Good: {name} {_good(answered)}, the diagnosis on the same cases {_good(same)}. "
            f"First name right where something of the catalogue is visible: {_share(*_first(answered))} "
            f"against {_share(*_first(same))}.",
            numbers(answered),
        ]
    return "\n\n".join([*parts, "## Mistakes", mistakes(lines)])


def outcomes(lines: Sequence[Line]) -> str:
    """A row a kind: how many of each outcome, and the share of good answers with its 95 % Wilson interval."""
    rows = []
    for label, own in _rows(lines):
        if not own:
            continue
        counts = Counter(line["outcome"] for line in own)
        good = sum(line["good"] for line in own)
        false = sum(line["false_findings"] for line in own)
        rows.append(
            [
                label,
                str(len(own)),
                _share(good, len(own)),
                *(str(counts[o] or "") for o in OUTCOMES),
                str(false),
            ]
        )
    return _table(["kind", "cases", "good (95 %)", *OUTCOMES, "false findings"], rows)


def _rows(lines: Sequence[Line]) -> Iterable[tuple[str, list[Line]]]:
    for kind in dict.fromkeys((*KINDS, *FIELD)):
        own = [line for line in lines if line["kind"] == kind]
        if kind == "clean":
            yield "clean, usual", [line for line in own if line["recorded"] == "usual"]
            yield "clean, odd or few", [line for line in own if line["recorded"] != "usual"]
        elif kind in ("outsider", "two_units"):
            yield kind, own
        else:
            yield f"{kind}, visible", [line for line in own if line["visible"]]
            yield f"{kind}, hardly visible", [line for line in own if not line["visible"]]


def numbers(lines: Sequence[Line]) -> str:
    """Coverage of intervals, false findings, error removed, time."""
    right = [f for line in lines for f in line["findings"] if f["is"] == "right"]
    held = [p["covered"] for f in right for p in f["parameters"].values() if p["covered"] is not None]
    gone = [
        line["removed"]
        for line in lines
        if line["visible"] and line["kind"] in ("single", "pair", "triple") and line["removed"] is not None
    ]
    cpu, wall = ([line[key] for line in lines] for key in ("cpu_s", "wall_s"))
    named = sum(len(line["findings"]) for line in lines)
    rows = [
        ["true parameter in its 95 % interval", _share(sum(held), len(held))],
        [
            "names that are true",
            _share(sum(f["is"] == "right" for line in lines for f in line["findings"]), named),
        ],
        ["removable held-out error removed, visible effects", _spread(gone, 100.0, "%")],
        ["CPU time a case", _spread(cpu, 1.0, "s")],
        ["wall time a case", _spread(wall, 1.0, "s")],
    ]
    return _table(["", "value"], rows)


def calibration(lines: Sequence[Line]) -> str:
    """Findings by stated probability: the mean of it, and the share that was true."""
    rows = []
    for (low, high), stated, true in calibration_classes(lines):
        if stated:
            rows.append(
                [
                    f"{low:g} to {high:g}",
                    str(len(stated)),
                    f"{np.mean(stated):.3f}",
                    _share(sum(true), len(true)),
                ]
            )
    return _table(["probability", "findings", "mean stated", "true (95 %)"], rows)


def calibration_classes(
    lines: Sequence[Line],
) -> Iterable[tuple[tuple[float, float], list[float], list[bool]]]:
    """Each class of probability with what was stated and whether it was true."""
    stated = [
        (f["probability"], f["is"] == "right")
        for line in lines
        for f in line["findings"]
        if f["probability"] is not None
    ]
    for low, high in pairwise(CLASSES):
        own = [(p, true) for p, true in stated if low < p <= high or (low == 0.0 and p == 0.0)]
        yield (low, high), [p for p, _ in own], [true for _, true in own]


def mistakes(lines: Sequence[Line]) -> str:
    """Every answer that was not good, by what went wrong; a case's name reproduces it."""
    several = ("pair", "triple")
    sections: list[tuple[str, Callable[[Line], bool]]] = [
        ("Wrong names", lambda x: x["outcome"] == "wrong" and x["kind"] in ("single", *several)),
        ("False extras beside the truth", lambda x: x["outcome"] == "extra"),
        ("Outsiders that were named", lambda x: x["kind"] == "outsider" and x["outcome"] == "wrong"),
        ("Visible outsiders called consistent", lambda x: _is(x, "outsider", True, "consistent")),
        ("Clean, and not called consistent", lambda x: x["kind"] == "clean" and not x["good"]),
        ("Single visible effects left unexplained", lambda x: _is(x, "single", True, "unexplained")),
        ("Single visible effects called consistent", lambda x: _is(x, "single", True, "consistent")),
        ("Hardly visible effects left unexplained", lambda x: _is(x, "single", False, "unexplained")),
        ("The true model itself does not reach the noise", _floor_is_high),
        (
            "Several, not all of them named",
            lambda x: x["kind"] in several and x["outcome"] not in ("wrong", "extra") and not x["good"],
        ),
        (
            "Of the field: a name, a value, the verdict or what disagrees",
            lambda x: x["kind"] in FIELD[1:] and x["outcome"] != "extra" and not x["good"],
        ),
    ]
    ran, failed = ([x for x in lines if ("failed" in x) is yes] for yes in (False, True))
    groups = [("Failed to run", failed), *((title, list(filter(test, ran))) for title, test in sections)]
    out = []
    for title, own in groups:
        if own:
            out += [f"### {title}: {len(own)}", "\n".join(_mistake(line) for line in own)]
    return "\n\n".join(out) or "None."


def _floor_is_high(line: Line) -> bool:
    """Whether rig and catalogue differ by more than noise, so that nobody could be right.

    Where something strange is there, or a recording is unlike the others, they do.
    """
    if line["kind"] in ("beside_stranger", "two_units"):
        return False
    return line["floor"] is not None and line["floor"] > 1.15 * line["floor_noise"]


def _is(line: Line, kind: str, visible: bool, outcome: str) -> bool:
    return (line["kind"], line["visible"], line["outcome"]) == (kind, visible, outcome)


def _mistake(line: Line) -> str:
    truth = "; ".join(
        f"{_place(t)} {', '.join(f'{k} {v:.4g}' for k, v in t['parameters'].items())}" for t in line["truth"]
    )
    if "failed" in line:
        return f"- `{line['case']}`: hidden {truth or 'nothing'}: {line['failed']}"
    named = "; ".join(
        f"{f['key']} ({f['is']}"
        + ("" if f["probability"] is None else f", p {f['probability']:.2f}")
        + (f", beside {', '.join(f['also'])}" if f["also"] else "")
        + ")"
        for f in line["findings"]
    )
    after = "" if line["after"] is None else f"{line['after']:.4f}"
    floor = (
        ""
        if line["floor"] is None
        else f", true model {line['floor']:.4f} ({line['floor'] / line['floor_noise']:.2f} times noise)"
    )
    off = [name for name, near in line.get("within", {}).items() if not near]
    ranking = ", ".join(f"{key} {share:.3f}" for key, share in line["ranking"][:3])
    return (
        f"- `{line['case']}` (error {line['error'] / line['noise_error']:.1f} times noise): hidden "
        f"{truth or 'nothing'}: {line['verdict']}, named {named or 'nothing'}; held-out {line['before']:.4f} "
        f"-> {after}{floor}{'; off: ' + ', '.join(off) if off else ''}; ranking {ranking or 'none'}"
    )


def _place(truth: Mapping[str, Any]) -> str:
    place = f"{truth['effect']}@{truth['axis']}" if truth["axis"] else truth["effect"]
    return place if truth["location"] == "actuator" else f"{place}({truth['location']})"


def _good(lines: Sequence[Line]) -> str:
    return _share(sum(line["good"] for line in lines), len(lines))


def _first(lines: Sequence[Line]) -> tuple[int, int]:
    """How many of the visible catalogued cases have the first name right, and how many there are."""
    own = [x for x in lines if x["visible"] and x["kind"] in ("single", "pair", "triple")]
    return sum(x["first_right"] for x in own), len(own)


def _share(good: int, of: int) -> str:
    if not of:
        return "none"
    low, high = wilson(good, of)
    return f"{good} of {of} ({100 * low:.0f} to {100 * high:.0f} %)"


def _spread(values: Sequence[float], factor: float, unit: str) -> str:
    if not values:
        return "none"
    low, middle, high = factor * np.percentile(values, [5, 50, 95])
    return f"median {middle:.1f} {unit}, 5 to 95 %: {low:.1f} to {high:.1f} {unit} ({len(values)})"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
