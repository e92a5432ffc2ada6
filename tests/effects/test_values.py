"""Values that no body can have are refused for every parameter of every effect, wherever they come from."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
import tomli_w

from tests.cli.here import run
from tests.effects.cases import ON_A_PLATE, ON_AN_ARM, VALUES
from workbench.core import EffectKey, InputError
from workbench.effects import EFFECTS, Effect, effect_named, load_model, places
from workbench.models import MOST, Placement

#: What else than a value may stand in the place of one.
_NONE = ("nan", "inf", "-inf", "much", "")


def place_of(effect: Effect) -> tuple[str, EffectKey]:
    """A shipped model that an effect can be added to, and where."""
    for name in ("leg", "leg_kin_only", ON_A_PLATE, ON_AN_ARM):
        found = [key for key in places(load_model(name)) if key.effect == effect.name]
        if found:
            return name, found[0]
    raise AssertionError(f"no shipped model takes {effect.name}: name one here")


def beyond(effect: Effect, name: str, key: EffectKey, model: str) -> Iterator[float]:
    """Values of a parameter below and above its bounds, or beyond all that a file may hold."""
    loaded = load_model(model)
    parameter = next(p for p in effect.parameters if p.name == name)
    low, high = parameter.lower, parameter.upper
    if (
        len(effect.parameters) == 1
    ):  # its one coefficient is the parameter, or less than it by what is neutral
        lows, highs = effect.parameters.bounds(loaded, Placement.of(loaded, key))
        low = lows[0] + parameter.neutral if len(lows) else low
        high = highs[0] + parameter.neutral if len(highs) else high
    yield low - 1e-3 * max(1.0, abs(low)) if math.isfinite(low) else -2 * MOST
    yield high + 1e-3 * max(1.0, abs(high)) if math.isfinite(high) else 2 * MOST


def words(key: EffectKey, values: dict[str, object]) -> list[str]:
    where = f"@{key.axis}" if key.axis else ""
    where += "(joint)" if key.location == "joint" else ""
    return [f"{key.effect}{where}", *(f"{name}={value}" for name, value in values.items())]


def refused_by_add(tmp_path: Path, model: str, key: EffectKey, values: dict[str, object]) -> None:
    """One clear line, exit code 2, nothing written."""
    done = run("add", model, *words(key, values), "-o", tmp_path / "refused.toml")
    assert done.returncode == 2, (values, done.stdout)
    assert len(done.stderr.strip().splitlines()) == 1 and "Traceback" not in done.stderr, done.stderr
    assert not (tmp_path / "refused.toml").exists()


def refused_in_a_file(whole: dict, parameters: dict[str, object], file: Path) -> None:
    """The same effect in a model file, with other parameters: an error that names the file."""
    changed = {
        **whole,
        "effects": [*whole["effects"][:-1], {**whole["effects"][-1], "parameters": parameters}],
    }
    file.write_text(tomli_w.dumps(changed))
    with pytest.raises(InputError, match=file.name) as error:
        load_model(str(file))
    assert error.value.exit_code == 2 and "\n" not in str(error.value)


@pytest.mark.parametrize("effect", [e.name for e in EFFECTS if e.parameters])
def test_no_value_that_a_body_cannot_have_is_taken(effect: str, tmp_path: Path) -> None:
    found = effect_named(effect)
    model, key = place_of(found)
    optional = {p.name for p in found.parameters if p.optional}
    good: dict[str, object] = {**VALUES[effect], **dict.fromkeys(optional, 0.1)}
    assert set(good) == {p.name for p in found.parameters}
    file = tmp_path / "good.toml"
    done = run("add", model, *words(key, good), "-o", file)
    assert done.returncode == 0, done.stderr
    whole = tomllib.loads(file.read_text())
    stated, wrong = whole["effects"][-1]["parameters"], tmp_path / "wrong.toml"
    for k, name in enumerate(good):
        # what is no number at all is one thing, whatever its name
        for value in (*beyond(found, name, key, model), *(() if k else _NONE)):
            refused_by_add(tmp_path, model, key, {**good, name: value})
        for value in (*beyond(found, name, key, model), math.nan, math.inf, -math.inf, "much"):
            refused_in_a_file(whole, {**stated, name: {**stated[name], "value": value}}, wrong)
        if name not in optional:
            refused_in_a_file(whole, {k: v for k, v in stated.items() if k != name}, wrong)
    name = next(iter(good))
    refused_by_add(tmp_path, model, key, {k: v for k, v in good.items() if k != name} or {"colour": 1.0})
    done = run("add", model, *words(key, good), f"{name}={good[name]}", "-o", tmp_path / "refused.toml")
    assert done.returncode == 2 and f"{name} is given twice" in done.stderr
    for value in (math.nan, math.inf, *beyond(found, name, key, model)):  # Python's JSON has these
        finding = {"effect": effect, "axis": key.axis, "location": key.location}
        finding["parameters"] = {**stated, name: {**stated[name], "value": value}}
        told = tmp_path / "told.json"
        told.write_text(json.dumps({"format": 1, "findings": [finding]}))
        done = run("add", model, "--from", told, "-o", tmp_path / "refused.toml")
        assert done.returncode == 2 and len(done.stderr.strip().splitlines()) == 1, done.stderr
    for value in (math.nan, -1.0, "wide"):
        refused_in_a_file(whole, {**stated, name: {**stated[name], "std": value}}, wrong)
    refused_by_add(tmp_path, model, key, {**good, "colour": 1.0})
    refused_in_a_file(whole, {**stated, "colour": {"value": 1.0, "std": 0.0, "unit": "1"}}, wrong)
