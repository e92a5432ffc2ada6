"""The page of the measured machines: one table of all, and of each what is named, missed or false."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from machine_table import Answer, Machine, Row, counts, machines, ratio, rows

from workbench.core import EffectKey, Estimate
from workbench.report.numbers import interval, number, percent, unit_text
from workbench.report.wording import capital, effect_name, effect_phrase

PAGE = Path(__file__).parents[1] / "docs" / "real-machines.md"
START, END = "<!-- machines: written by analyses/real_machines.py -->\n", "<!-- end of machines -->\n"
_COLUMNS = (
    "machine",
    "verdict",
    "right causes named",
    "values outside, false names",
    "error over noise",
    "time",
)
_SAID = {
    "consistent": "nothing is missing",
    "missing_effect": "missing effects named",
    "partly_explained": "part of the missing effects named",
    "unexplained": "something is missing, nothing named",
}
_STATES = {
    "named": "named",
    "read": "right",
    "outside": "**outside the tolerance**",
    "not named": "**not named**",
    "false": "**false: not known to be there**",
}


def page(answers: Mapping[str, Answer]) -> str:
    """The page with fresh tables between its marks."""
    before, rest = PAGE.read_text(encoding="utf-8").split(START)
    return before + START + "\n" + "\n".join(_tables(answers)) + "\n" + END + rest.split(END)[1]


def _tables(answers: Mapping[str, Answer]) -> Iterator[str]:
    yield f"| {' | '.join(_COLUMNS)} |"
    yield "|" + "---|" * len(_COLUMNS)
    for machine in machines():
        if machine["name"] in answers:
            yield _summary(machine, answers[machine["name"]])
    for machine in machines():
        if machine["name"] in answers:
            yield from _section(machine, answers[machine["name"]])


def _summary(machine: Machine, answer: Answer) -> str:
    title = f"[{machine['title']}](#{machine['name']})"
    if "failed" in answer:
        return f"| {title} | **no answer** | – | – | {number(ratio(answer, 'before'))} as given | – |"
    found = rows(machine, answer)
    n = counts(found)
    of = f"{n['named']} of {len(machine['right'])}" if "right" in machine else "–"
    bad = f"{n['outside']}, {n['false']}" if found or "reached" in machine else "–"
    errors = f"{number(ratio(answer, 'before'))} to {number(ratio(answer, 'after'))}"
    return f"| {title} | {_SAID[answer['verdict']]} | {of} | {bad} | {errors} | {answer['seconds']:.0f} s |"


def _section(machine: Machine, answer: Answer) -> Iterator[str]:
    yield f'\n<a id="{machine["name"]}"></a>\n\n### {machine["title"]}\n'
    yield f"- From: {machine['source']}"
    yield f"- Model: {machine['given']}"
    yield f"- Known about the machine: {machine['known']}"
    if "failed" in answer:
        yield f"- Verdict: none. The search ended with `{answer['failed']}`"
        yield f"- Error on {machine['judged']}, as given: {number(ratio(answer, 'before'))} times the noise"
        return
    yield f"- Verdict: {answer['sentence']}"
    yield f"- Error on {machine['judged']}: {_errors(answer)}"
    if answer["nearest"]:
        near = ", ".join(_effect(s["effect"], s["axis"], s["location"]) for s in answer["nearest"])
        left = number(_nearest(answer))
        yield f"- Nearest effect, not named: {near}; with it, the error is {left} times the noise"
    if answer["verdict"] != "consistent":
        rest = percent(answer["unexplained"])
        yield f"- Part of the squared error above the noise that stays unexplained, on fitted data: {rest}"
    yield from (f"- About the rest: {line}" for line in answer["evidence"])
    found = rows(machine, answer)
    if found:
        yield "\n| cause | known value | found, with 95 % interval | |"
        yield "|---|---|---|---|"
        yield from (_row(r) for r in found)


def _errors(answer: Answer) -> str:
    before, after = (answer["judged"][k] for k in ("before", "after"))
    if not answer["findings"]:
        after = before
    text = f"{number(before['error'])} to {number(after['error'])}; noise floor {number(after['noise'])}"
    force = [number(100.0 * e["force_error"]) if e["force_error"] else "" for e in (before, after)]
    if force[0] == force[1]:  # none was measured, or what was found shows in the motion and not there
        return text
    return f"{text}. Relative error of torque along the measured motion: {force[0]} to {force[1]} %"


def _nearest(answer: Answer) -> float:
    after = answer["judged"]["after"]
    return after["error"] / after["noise"]


def _row(r: Row) -> str:
    read = r.what.removesuffix("_hz").replace("_", " ")
    what = capital(_effect(r.what, r.axis, "actuator") if r.parameter else read)
    what += f", {r.parameter.replace('_', ' ')}" if r.parameter else ""
    known = "–" if r.known is None else f"{r.known:g}"
    said = "–" if r.found is None else interval(Estimate(r.found["value"], r.found["std"], r.found["unit"]))
    if r.known is not None and r.found is not None:
        known += f" {unit_text(r.found['unit'])}"
    return f"| {what} | {known} | {said} | {_STATES[r.state]} |"


def _effect(effect: str, axis: str | None, location: str) -> str:
    if axis is None:
        return effect_name(effect)
    return effect_phrase(EffectKey(effect, axis, "joint" if location == "joint" else "actuator"))
