"""docs/diagnosis.md states the numbers that the code has."""

from __future__ import annotations

import re
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import pytest

from workbench.diagnosis.policy import POLICY

PAGE = " ".join((Path(__file__).parents[2] / "docs" / "diagnosis.md").read_text(encoding="utf-8").split())
_WORDS = {200: "200"}
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
    if module == "policy":
        return getattr(POLICY, name)
    near = module if module.startswith(".") else f".{module}"
    return getattr(import_module(near, "workbench.diagnosis"), name)


# field of the policy, or module (from workbench.diagnosis) and constant; how the page writes it; words around
NUMBERS = [
    ("policy", "explained", percent, "explain at least {} of the squared error above the noise"),
    ("policy", "explained_elsewhere", percent, "or explain more than {} of the squared error above it"),
    ("policy", "effect_gain", percent, "removes more than {} of the squared error above the noise on data"),
    ("policy", "tie", percent, "test errors agree within {}, the one"),
    ("policy", "significant", word(3.0, "three"), "within {} deviations of zero"),
    ("policy", "small_effect", percent, "for effects of {} of the drives' torque"),
    ("policy", "later_fall", part, "lowers the total error by {} and"),
    ("policy", "later_gain", part, "more than {} of the remaining squared error above the noise"),
    ("policy", "plain_rest_left", percent, "leaves no more than {} of a small, clear remainder"),
    ("policy", "exchange_left", part, "leaves less than {} of the best's excess error"),
    ("policy", "most_effects", word(6, "six"), "or more than {} effects are missing"),
    ("policy", "most_effects", word(6, "six"), "At most {} effects are added one after the other"),
    ("policy", "effect_gain", percent, "removes at least {} (inertia, damping, Coulomb friction)"),
    ("policy", "later_gain", percent, "or {} (all others)"),
    ("policy", "explained", percent, "explain nearly as much ({})"),
    ("policy", "basic_share", percent, "explains less than {} of what the refinement does"),
    ("policy", "significant", word(3.0, "three"), "within {} standard deviations of zero are left out"),
    ("policy", "significant", word(3.0, "three"), "stays at least {} standard deviations above"),
    ("policy", "explained", percent, "the law reaches {} of it"),
    ("policy", "basic_law", percent, "of it, or {} if it is inertia, damping and Coulomb"),
    ("policy", "near_named", percent, "Effects that remove at least {} of the excess, but not enough"),
    ("policy", "something", percent, "but at least {}, only the existence of a partial"),
    ("policy", "replacement_close", times, "it left less than {} as much"),
    ("policy", "merge_size", part, "at most {} as many parameters"),
    ("policy", "torque_first", percent, "it leaves no more than {} of the squared residual torque"),
    ("policy", "budget_runs", count, "each recording at least {} times"),
    ("policy", "holdout_informative", times, "a squared error less than {} the noise's"),
    ("policy", "relation_beside", part, "if it explains at least {} of the residual's power"),
    ("policy", "shape_share", percent, "still depends on positions ({} of its power)"),
    ("..comparison.drift", "_PART", word(0.01, "a hundredth"), "{} of its torque moves it further"),
    (
        "..comparison.simulated",
        "_MOST",
        word(1e-3, "a thousandth"),
        "no larger than {} of the signal's standard",
    ),
    ("..comparison.closed_loop", "_SHIFT", word(0.05, "a twentieth"), "torque {} of a tick late"),
    ("policy", "budget_steps", word(1e8, "a hundred million"), "After {} simulated steps of a coordinate"),
    ("evidence.relations", "_BLOCK_S", word(1.0, "one second"), "shuffled in blocks of {}"),
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
    orders = import_module("workbench.diagnosis.evidence.relations")._ORDERS
    assert f"up to {max(orders)} periods per revolution" in PAGE


def test_no_threshold_of_the_page_is_left_unlooked_at() -> None:
    """Shares and multiples in the text before the record of examinations are all in the list above."""
    text = PAGE[: PAGE.index("## How it is examined")]
    known = " ".join(
        around.format(written(constant(module, name))) for module, name, written, around in NUMBERS
    )
    for share in re.findall(r"[\d.]+ (?:%|times)", text):
        # 100 % and a 95 % interval are words of the field
        assert share in known or share in ("100 %", "95 %"), share
