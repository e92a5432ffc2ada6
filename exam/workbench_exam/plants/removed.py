"""How far the model moves from the machine on a motion that no solver saw, before and after an answer."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

from workbench_exam.answers import Answer
from workbench_exam.vocabulary import EFFECTS

from .drawn import Drawn, apart, judged, true_plant
from .plant import Plant, Ticks, with_effect
from .write import drawn_of


def judge(told: Mapping[str, Any], answer: Answer) -> dict[str, float]:
    """Errors over what noise makes: `before`, `after` what is named, and with the true effects (`floor`).

    A value that is not given, or an effect that the machine cannot have, changes nothing.
    """
    drawn, truth, noise, before, floor = _known(json.dumps(told, sort_keys=True))
    plant = drawn.file
    for each in answer.named:
        if set(each.values) == set(EFFECTS[each.effect]):
            plant = _with(plant, each.effect, each.place, {name: v[0] for name, v in each.values.items()})
    after = before if plant == drawn.file else _error(plant, drawn, truth, noise)
    return {"before": before, "after": after, "floor": floor}


@lru_cache(maxsize=256)
def _known(told: str) -> tuple[Drawn, Ticks, float, float, float]:
    """What every answer to a case is held against: the machine's motion, what noise makes, file and floor."""
    drawn = drawn_of(json.loads(told))
    whole = true_plant(drawn)
    truth = judged(whole, drawn)
    noise = apart(truth, judged(whole, drawn, noisy=True))
    before = _error(drawn.file, drawn, truth, noise) if whole != drawn.file else 0.0
    floor = _error(replace(whole, strangers=()), drawn, truth, noise) if whole.strangers else 0.0
    return drawn, truth, noise, before, floor


def _error(plant: Plant, drawn: Drawn, truth: Ticks, noise: float) -> float:
    try:
        return round(apart(truth, judged(plant, drawn)) / noise, 4)
    except ArithmeticError:
        return float("inf")


def _with(plant: Plant, effect: str, place: str | None, values: Mapping[str, float]) -> Plant:
    try:
        return with_effect(plant, effect, place, values)
    except ValueError:
        return plant
