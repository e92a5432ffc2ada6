"""What table and page say of a fleet."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from workbench.core import Estimate
from workbench.core.text import counted
from workbench.report.answer import in_words
from workbench.report.numbers import number, plain
from workbench.report.wording import any_of, capital, effect_phrase, parameter_name, times_noise

from .result import Fleet, Shared, key_of

_SHOWN = 4  # names in a sentence
_DIFFER = 0.01  # p-value below which scatter is more than the intervals'


def sentence(fleet: Fleet) -> str:
    """Return how many robots lack what."""
    total, done = len(fleet.robots), fleet.diagnosed
    lacking = [r for r in done if r["verdict"] in ("missing_effect", "partly_explained")]
    open_ = [r for r in done if r["verdict"] == "unexplained"]
    parts = [f"A missing effect was found in {len(lacking)} of {counted(total, 'robot')}"]
    if fleet.effects:
        first = fleet.effects[0]
        often = "most often " if len(fleet.effects) > 1 else ""
        parts[0] += f" ({often}{effect_phrase(first.key)}: {len(first.robots)})"
    if open_:
        parts.append(f"{len(open_)} with an unexplained error")
    fine = len(done) - len(lacking) - len(open_)
    if fine:
        parts.append(f"{fine} consistent")
    if fleet.failed:
        parts.append(f"{len(fleet.failed)} could not be diagnosed")
    return "; ".join(parts) + "."


def verdict_words(robot: Mapping[str, Any]) -> str:
    """Return the verdict of one robot in a few words."""
    if robot["failed"] is not None:
        return "failed"
    return {
        "missing_effect": "missing",
        "partly_explained": "missing, and more",
        "consistent": "consistent",
    }.get(robot["verdict"], "unexplained")


def errors(robot: Mapping[str, Any]) -> tuple[str, str, str]:
    """Error before and after, in noise floors, and held-out error after over that before."""
    way = robot["improvement"]
    if way is None:
        return "", "", ""
    floor = way["noise_error"] or math.nan
    before, after = (times_noise(way[k] or math.nan, floor) for k in ("error_before", "error_after"))
    held = way["holdout_error_before"], way["holdout_error_after"]
    judged = "" if None in held else f"{number(held[0])} → {number(held[1])}"
    return before.replace(" times", ""), after.replace(" times", ""), judged


def findings(robot: Mapping[str, Any]) -> list[str]:
    """Each finding with its parameters, or why there is none."""
    if robot["failed"] is not None:
        return [plain(robot["failed"])]
    lines = []
    for f in robot["diagnosis"]["findings"]:
        told = {n: Estimate(p["value"], p["std"] or 0.0, p["unit"]) for n, p in f["parameters"].items()}
        values = ", ".join(in_words(told))
        what = capital(effect_phrase(key_of(f)))
        lines.append(plain(f"{what}: {values}" if values else what))
    return lines


def differences(effect: Shared) -> list[str]:
    """Return one sentence per parameter that differs between robots."""
    lines = []
    for name, told in effect.spreads.items():
        apart = effect.peculiar(name)
        what = f"{capital(effect_phrase(effect.key))}, {parameter_name(name)}"
        if apart:
            who = any_of(
                [f"{plain(p.robot)} ({p.deviations:+.1f} standard deviations)" for p in apart[:_SHOWN]], "and"
            )
            lines.append(f"{what}: {who} {'stand' if len(apart) > 1 else 'stands'} out from the others.")
        elif told.p_value < _DIFFER:
            lines.append(
                f"{what}: robots scatter {number(told.ratio)} times as much as their intervals allow."
            )
    return lines


def seen(effect: Shared) -> str:
    """Who has it, who may, and whose recordings would not show it."""
    parts = [f"{len(effect.robots)} ({_names(effect.robots)})"]
    parts += [f"perhaps {_names(effect.perhaps)}"] if effect.perhaps else []
    parts += [f"not identifiable in {_names(effect.unseen)}"] if effect.unseen else []
    return "; ".join(parts)


def _names(names: tuple[str, ...]) -> str:
    shown = [plain(n) for n in names[:_SHOWN]]
    more = len(names) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")
