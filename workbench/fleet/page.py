"""The page of a fleet."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.core import Estimate
from workbench.core.text import counted
from workbench.report.numbers import interval, number, unit_text
from workbench.report.sheet import Curve, Drawing, Panel, Row, Section, Sheet, SheetTable
from workbench.report.wording import capital, effect_phrase, parameter_name

from . import wording as w
from .result import Fleet, Shared

_Z95 = 1.96


def fleet_sheet(fleet: Fleet) -> Sheet:
    """Robots, effects with how their parameters differ, and what failed."""
    verdicts = {r["verdict"] for r in fleet.robots}
    tone = (
        "consistent" if verdicts == {"consistent"} else "missing_effect" if fleet.effects else "unexplained"
    )
    robots = SheetTable(
        "Errors before and after are multiples of the noise floor; held-out errors are before → after",
        ("Robot", "Verdict", "What was found", ">Before", ">After", ">Held-out"),
        tuple((r["rig"], w.verdict_words(r), "; ".join(w.findings(r)), *w.errors(r)) for r in fleet.robots),
    )
    left_out = tuple(f"{r['rig']}: left out: {x['problem']}" for r in fleet.robots for x in r["left_out"])
    recordings = sum(len(r["recordings"]) + len(r["held_out"]) for r in fleet.robots)
    return Sheet(
        kind="fleet",
        model=counted(len(fleet.robots), "robot"),
        tone=tone,
        sentence=w.sentence(fleet),
        lines=tuple(line for e in fleet.effects for line in w.differences(e))[:3],
        key_numbers=(
            ("Robots", str(len(fleet.robots)), f"{len(fleet.failed)} without a diagnosis"),
            ("Recordings", str(recordings), "fitted or held out"),
            ("Effects", str(len(fleet.effects)), "found; an effect at two places counts twice"),
        ),
        sections=(
            Section("robots", "Robots", tables=(robots,), remarks=left_out),
            *(_effect(k, e) for k, e in enumerate(fleet.effects)),
        ),
    )


def _effect(number_: int, e: Shared) -> Section:
    tables, panels = [], []
    for name, by_robot in e.parameters.items():
        told, apart = e.spreads.get(name), {p.robot for p in e.peculiar(name)}
        off = iter(told.deviations if told else ())
        rows = [
            (
                robot,
                interval(x),
                number(float(next(off, np.nan)), 2) if x.std > 0 else "",
                "yes" if robot in apart else "",
            )
            for robot, x in by_robot.items()
        ]
        caption = capital(parameter_name(name))
        if told:
            unit = next(iter(by_robot.values())).unit
            caption += (
                f": all robots {interval(Estimate(told.mean, told.std, unit))}; scatter {number(told.ratio)} "
                f"times what the intervals allow (p = {number(told.p_value, 2)})"
            )
        header = (
            "Robot",
            ">Estimate (95 %)",
            ">Difference from the others [standard deviations]",
            "Stands out",
        )
        tables.append(SheetTable(caption, header, tuple(rows)))
        if told and len(by_robot) > 2:
            panels.append(_panel(name, by_robot, told.mean))
    drawings = (Drawing(tuple(panels), "Estimates with 95 % intervals; line: all robots."),) if panels else ()
    return Section(
        f"effect-{number_ + 1}",
        capital(effect_phrase(e.key)),
        sentences=(f"Robots that have it: {w.seen(e)}.", *w.differences(e)),
        tables=tuple(tables),
        drawings=drawings,
    )


def _panel(name: str, by_robot: Mapping[str, Estimate], mean: float) -> Panel:
    x = np.arange(1.0, len(by_robot) + 1)
    value = np.array([e.value for e in by_robot.values()])
    half = _Z95 * np.array([e.std for e in by_robot.values()])
    unit = unit_text(next(iter(by_robot.values())).unit)
    curves = (
        Curve("95 %", "noise", x, None, value - half, value + half),
        Curve("robot", "measured", x, value),
        Curve("all robots", "fit", x, np.full(len(x), mean)),
    )
    label = f"{parameter_name(name)} [{unit}]" if unit else parameter_name(name)
    summary = f"{capital(parameter_name(name))} of {len(x)} robots."
    row = Row(label, curves)
    return Panel(capital(parameter_name(name)), "robot, in the table's order", (row,), summary, log=False)
