"""What a run of the exam has better, worse or other than the committed one, case by case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from workbench.diagnosis.moves.order import MOVES

from .compact import Line

#: What a case can be, the worst first. Of answers that are the same, the work says the rest.
HOW = ("worse", "better", "other", "more work", "less work")
_SCORE = {"right": 2, "look-alike": 1, "false": 0}
_WORK = 1.1  # a factor of the work beyond which it is said
_TIME = 2.0  # the same of processor time, which depends on what else runs


class Change(NamedTuple):
    """What is different in a case: one of `HOW`, and in words."""

    case: str
    how: str
    words: str


def changes(old: Sequence[Line], new: Sequence[Line]) -> list[Change]:
    """What changed in the cases that both have, in the order of the new ones.

    The answer decides first: good or not, how many names are right and false, values in their intervals. Of
    answers as good as each other, other names, places, verdicts or values are ``other``.
    """
    before = {line["case"]: line for line in old}
    found = (_change(before[line["case"]], line) for line in new if line["case"] in before)
    return [change for change in found if change is not None]


def report(old: Sequence[Line], new: Sequence[Line]) -> str:
    """`changes` as text, the worst first, and sums over the cases that both have."""
    found = changes(old, new)
    both = {line["case"] for line in old} & {line["case"] for line in new}
    parts = []
    for how in HOW:
        own = [f"- `{c.case}`: {c.words}" for c in found if c.how == how]
        parts += [f"## {how.capitalize()}: {len(own)}", *own] if own else []
    missing = len(old) - len(both)
    parts.append(
        f"{len(both)} cases in both, {len(both) - len(found)} as before; {missing} of the old not run, "
        f"{len(new) - len(both)} new."
    )
    for key, what, unit in (("work", "Work", "steps"), ("cpu_s", "Processor time", "s")):
        pairs = _pairs(old, new, key)
        if pairs:
            was, now = (sum(column) for column in zip(*pairs, strict=True))
            parts.append(
                f"{what} of {len(pairs)} cases: {was:.4g} -> {now:.4g} {unit} ({now / was:.2f} times)."
            )
    return "\n".join([*parts, *_moves(new)])


def _moves(lines: Sequence[Line]) -> list[str]:
    """Of each move of the search, in how many cases it led to a better node; those in none last.

    A move that never does is one that the search could do without.
    """
    ways = [line["moves"] for line in lines if line.get("moves")]
    if not ways:
        return []
    counts = {move.name: sum(move.name in way for way in ways) for move in MOVES}
    ordered = sorted(counts.items(), key=lambda c: -c[1])
    return [
        f"Moves that led to something better, of {len(ways)} cases:",
        *(f"- {n}: {m}" for m, n in ordered),
    ]


def _pairs(old: Sequence[Line], new: Sequence[Line], key: str) -> list[tuple[float, float]]:
    before = {line["case"]: line.get(key) for line in old}
    pairs = [(before.get(line["case"]), line.get(key)) for line in new]
    return [(was, now) for was, now in pairs if was and now]


def _change(old: Line, new: Line) -> Change | None:
    answers, (times, effort) = _answers(old, new), _effort(old, new)
    if not answers and not effort:
        return None
    was, now = _worth(old), _worth(new)
    if now == was:
        how = "other" if answers else "more work" if times > 1.0 else "less work"
    else:
        how = "better" if now > was else "worse"
    return Change(new["case"], how, "; ".join([*answers, *effort]))


def _worth(line: Line) -> tuple[float, ...]:
    """What an answer is worth, more is better: compared from the left."""
    if "failed" in line:
        return (-1.0,)
    if "marks" in line:
        m = line["marks"]
        return (0.0, m["named"] - m["outside"] - 2 * m["false"], -m["false"])
    score = sum(_SCORE[f["is"]] for f in line["named"])
    false = sum(f["is"] == "false" for f in line["named"])
    held = [covered for f in line["named"] for *_, covered in f["values"].values() if covered is not None]
    return (float(line["good"]), -false, score, -float(held.count(False)))


def _answers(old: Line, new: Line) -> list[str]:
    """How two answers differ, in words."""
    if "failed" in old or "failed" in new:
        pair = [line.get("failed", "an answer") for line in (old, new)]
        return [] if pair[0] == pair[1] else [f"{pair[0]} -> {pair[1]}"]
    words = []
    for key in ("verdict", "outcome", "marks"):
        if old.get(key) != new.get(key):
            words.append(f"{key} {_shown(old[key])} -> {_shown(new[key])}")
    was, now = ({f["key"]: f for f in line["named"]} for line in (old, new))
    gone = [_called(f) for key, f in was.items() if key not in now]
    come = [_called(f) for key, f in now.items() if key not in was]
    if gone or come:
        words.append(f"named {' + '.join(gone) or 'nothing'} -> {' + '.join(come) or 'nothing'}")
    for key in filter(now.__contains__, was):
        words += [f"{key} {text}" for text in _values(was[key]["values"], now[key]["values"])]
    return words


def _values(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Values that left or entered their interval, or moved by more than half the wider one."""
    words = []
    for name in filter(new.__contains__, old):
        (a, wide_a, in_a), (b, wide_b, in_b) = old[name], new[name]
        moved = abs(b - a) > 0.5 * max(wide_a or 0.0, wide_b or 0.0) + 1e-3 * abs(a)
        if in_a != in_b or moved:
            inside = {True: " (in)", False: " (out)", None: ""}
            words.append(f"{name} {a:g} ± {wide_a:g}{inside[in_a]} -> {b:g} ± {wide_b:g}{inside[in_b]}")
    return words


def _effort(old: Line, new: Line) -> tuple[float, list[str]]:
    """How many times the work is done, or, where that was not counted, the time; in words if that is much."""
    for key, most, unit in (("work", _WORK, "steps"), ("cpu_s", _TIME, "s")):
        was, now = old.get(key), new.get(key)
        if was and now:
            much = max(was / now, now / was) > most
            words = [f"{now / was:.2f} times the work ({was:.3g} -> {now:.3g} {unit})"]
            return now / was, words if much else []
    return 1.0, []


def _called(finding: Line) -> str:
    return f"{finding['key']} ({finding['is']})" if "is" in finding else finding["key"]


def _shown(value: Any) -> str:
    return ", ".join(f"{k} {v}" for k, v in value.items()) if isinstance(value, Mapping) else str(value)
