"""A fleet's result for the terminal: robots, effects, and where robots differ."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Group, RenderableType
from rich.text import Text

from workbench.core import Estimate
from workbench.report.layout import table, text, verdict
from workbench.report.numbers import interval, number
from workbench.report.wording import capital, effect_phrase, parameter_name

from . import wording as w
from .result import Fleet


def fleet_table(fleet: Fleet) -> Group:
    """Verdict, a row per robot, a row per effect, and who stands out."""
    robots = table("robot", "verdict", ("x noise", "right"), ("after", "right"), "held-out", "what was found")
    robots.columns[0].overflow = robots.columns[5].overflow = "fold"
    for r in fleet.robots:
        before, after, judged = w.errors(r)
        lines = "\n".join(w.findings(r))
        robots.add_row(text(r["rig"]), w.verdict_words(r), before, after, judged, text(lines))
    fine = all(r["verdict"] == "consistent" for r in fleet.robots)
    parts: list[RenderableType] = [verdict(w.sentence(fleet), fine), robots]
    if fleet.effects:
        effects = table("effect", "robots", "parameter", ("all", "right"), ("scatter", "right"))
        for e in fleet.effects:
            rows = [
                (
                    parameter_name(n),
                    interval(Estimate(s.mean, s.std, _unit(e.parameters[n]))),
                    number(s.ratio),
                )
                for n, s in e.spreads.items()
            ] or [("", "", "")]
            for k, row in enumerate(rows):
                head = (capital(effect_phrase(e.key)), w.seen(e)) if k == 0 else ("", "")
                effects.add_row(*(text(x) for x in head), *row)
        parts += [Text(), effects]
    parts += [text(line) for e in fleet.effects for line in w.differences(e)]
    parts += [
        text(f"Note: {r['rig']}: left out: {entry['problem']}")
        for r in fleet.robots
        for entry in r["left_out"]
    ]
    parts += [text(f"Note: {note}") for r in fleet.diagnosed for note in r["improvement"]["notes"]]
    if any(e.spreads for e in fleet.effects):
        parts.append(
            Text("± is half a 95 % interval; scatter of robots is a multiple of what these intervals allow.")
        )
    return Group(*parts)


def _unit(estimates: Mapping[str, Estimate]) -> str:
    return next((e.unit for e in estimates.values()), "")
