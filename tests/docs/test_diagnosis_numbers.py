"""docs/diagnosis.md states the numbers that the code has."""

from __future__ import annotations

import re
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import pytest

PAGE = " ".join((Path(__file__).parents[2] / "docs" / "diagnosis.md").read_text(encoding="utf-8").split())
_WORDS = {3: "three", 4: "four", 6: "six", 200: "200"}
_PARTS = {0.75: "three quarters", 0.25: "a quarter", 0.1: "a tenth", 0.5: "half"}


def percent(value: float) -> str:
    return f"{100.0 * value:g} %"


def part(value: float) -> str:
    return _PARTS.get(value, f"{value:g}")


def count(value: float) -> str:
    return _WORDS[int(value)] if value == int(value) else f"{value:g}"


def times(value: float) -> str:
    return f"{value:g} times"


def word(value: float, said: str) -> Callable[[float], str]:
    return lambda now: said if now == value else f"{now:g}"


def constant(module: str, name: str) -> float:
    near = module if module.startswith(".") else f".{module}"
    return getattr(import_module(near, "workbench.diagnosis"), name)


# module, from workbench.diagnosis, constant, how the page writes it, and the words around it
NUMBERS = [
    ("judging", "EXPLAINED", percent, "explain at least {} of the squared error above the noise"),
    ("judging", "EXPLAINED", percent, "Where {} are explained and yet more than noise stays"),
    ("judging", "EXPLAINED", percent, "the same effects on every axis may explain {}"),
    ("judging", "NEARLY_ALL", percent, "or to explain more than {} of the squared error above it"),
    ("judging", "NEARLY_ALL", percent, "or explains more than {} of the squared error above it."),
    (
        "judging",
        "HELPS",
        percent,
        "removes more than {} of the squared error above the noise on data",
    ),
    ("judging", "TIE", percent, "explanations that judge within {}, the one"),
    ("judging", "CLEARLY", count, "within {} deviations of none"),
    (
        "judging",
        "_MOST",
        part,
        "removes more than {} of the squared error above the noise that the",
    ),
    ("judging", "_MOST", part, "more than {} of it on held-out recordings"),
    ("judging", "_LATER", part, "lower the whole error by {} too"),
    (
        "judging",
        "LATER_SHARE",
        part,
        "more than {} of the squared error that is left above the noise",
    ),
    ("judging", "_PLAIN", times, "squared error is more than {} the noise's, leave"),
    ("judging", "_LITTLE", percent, "leave no more than {} above the noise"),
    ("judging", "_OVERSHADOWED", times, "is more than {} the held-out one's"),
    ("search", "LIMIT", word(6, "six"), "more is missing than {} effects"),
    ("judging", "HELPS", percent, "removes at least {} (inertia, damping, Coulomb friction)"),
    ("judging", "LATER_SHARE", percent, "or {} (all others)"),
    ("judging", "EXPLAINED", percent, "explains nearly as much ({})"),
    ("choosing", "BASIC", percent, "explains less than {} of what it does"),
    ("judging", "CLEARLY", word(3.0, "three"), "not {} standard deviations from nothing"),
    ("judging", "CLEARLY", word(3.0, "three"), "stays {} standard deviations above nothing"),
    ("judging", "EXPLAINED", percent, "the law reaches {} of it"),
    ("findings", "NEAR", percent, "What removes {} or more, and still too little"),
    ("findings", "_SOME", percent, "of {} or more, only that there is something"),
    ("search", "LIMIT", count, "at most {} effects one after the other"),
    ("instead", "_CLOSE", times, "that had left less than {} as much"),
    ("instead", "_MOST", count, "up to {} others that had left"),
    ("one_for_two", "_MANY", count, "Two causes that have {} parameters or more together"),
    ("one_for_two", "_LESS", part, "for one with at most {} as many"),
    ("giving", "_LEFT", percent, "leaves more than {} of the squared torque that is lacking"),
    ("by_torque", "LITTLE", part, "leaves at most {} of the squared torque that is lacking"),
    (
        "other_ways",
        "_NEXT_TO_NOTHING",
        percent,
        "Where it leaves no more than {}, that comes first",
    ),
    ("effort", "_RUNS", count, "each recording {} times at least"),
    ("evidence", "_RULES", part, "where it explains at least {} of the residual's power"),
    ("evidence", "_SHAPED", percent, "still follows positions ({} of its power)"),
    ("..comparison.drift", "_PART", word(0.01, "a hundredth"), "{} of its torque moves it further"),
    (
        "..comparison.simulated",
        "_MOST",
        word(1e-3, "a thousandth"),
        "no more than {} of its own standard",
    ),
    ("..comparison.closed_loop", "_SHIFT", word(0.05, "a twentieth"), "torque {} of a tick late"),
    (
        "effort",
        "_STEPS",
        word(1e8, "a hundred million"),
        "simulated {} steps of a coordinate",
    ),
    ("beside_gap", "_LESS", word(0.8, "a fifth less"), "leaves {} of the squared torque"),
    ("relations", "_BLOCK_S", word(1.0, "a second"), "shuffled in blocks of {}"),
]


@pytest.mark.parametrize(("module", "name", "written", "around"), NUMBERS)
def test_the_page_has_the_number_of_the_code(
    module: str, name: str, written: Callable[[float], str], around: str
) -> None:
    value = constant(module, name)
    phrase = around.format(written(value))
    assert phrase in PAGE, f"{module}.{name} is {value}: the page does not say '{phrase}'"


def test_numbers_that_are_made_of_others() -> None:
    closed_loop = import_module("workbench.comparison.closed_loop")
    latest = 1e3 * closed_loop._SHIFT * closed_loop._LONGEST
    assert f"at most {latest:g} ms" in PAGE
    orders = import_module("workbench.diagnosis.relations")._ORDERS
    assert f"up to {max(orders)} times a revolution" in PAGE


def test_no_threshold_of_the_page_is_left_unlooked_at() -> None:
    """Shares in the text before the record of examinations are all in the list above."""
    text = PAGE[: PAGE.index("## How it is examined")]
    known = " ".join(
        around.format(written(constant(module, name))) for module, name, written, around in NUMBERS
    )
    for share in re.findall(r"[\d.]+ %", text):
        # 100 % and a 95 % interval are words of the field
        assert share in known or share in ("100 %", "95 %"), share
