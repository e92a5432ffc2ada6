"""How far the model moves from the machine on a motion that no solver saw, before and after an answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from workbench_exam.answers import Answer
from workbench_exam.vocabulary import EFFECTS

from .drawn import apart, judged, true_plant
from .plant import Plant, with_effect
from .write import drawn_of


def judge(told: Mapping[str, Any], answer: Answer) -> dict[str, float]:
    """Errors over what noise makes: `before`, `after` what is named, and with the true effects (`floor`).

    A value that is not given, or an effect that the machine cannot have, changes nothing.
    """
    drawn = drawn_of(dict(told))
    whole = true_plant(drawn)
    truth = judged(whole, drawn)
    noise = apart(truth, judged(whole, drawn, noisy=True))
    plant = drawn.file
    for each in answer.named:
        if set(each.values) == set(EFFECTS[each.effect]):
            plant = _with(plant, each.effect, each.place, {name: v[0] for name, v in each.values.items()})

    def error(p: Plant) -> float:
        try:
            return round(apart(truth, judged(p, drawn)) / noise, 4)
        except ArithmeticError:
            return float("inf")

    return {"before": error(drawn.file), "after": error(plant), "floor": error(replace(whole, strangers=()))}


def _with(plant: Plant, effect: str, place: str | None, values: Mapping[str, float]) -> Plant:
    try:
        return with_effect(plant, effect, place, values)
    except ValueError:
        return plant
