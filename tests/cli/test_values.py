"""Effects as one writes them: one number each, or lists where an effect may act several times in a place."""

from __future__ import annotations

from pathlib import Path

import pytest

from workbench.cli.add import with_effects
from workbench.cli.values import parse_values
from workbench.core import InputError
from workbench.effects import load_model
from workbench.models import write_model


def test_harmonics_are_written_and_read_again(tmp_path: Path) -> None:
    leg = load_model("leg")
    added, model = with_effects(
        leg, "cogging@hip", ["torque=0.3,0.1", "order=7,28", "phase=0,1"], diagnosis=None
    )
    assert [str(a.key) for a in added] == ["cogging@hip", "cogging@hip#2"]
    write_model(model, tmp_path / "rippled.toml")
    again = load_model(tmp_path / "rippled.toml")
    assert [(a.key, a.values) for a in again.effects] == [(a.key, a.values) for a in model.effects]


@pytest.mark.parametrize(
    ("effect", "values", "problem"),
    [
        ("cogging@hip", ["torque=0.3,0.1", "order=7", "phase=0,1"], "order: values given 1, wanted 2"),
        ("cogging@hip", ["torque=0.3,x", "order=7,28", "phase=0,1"], "not name=value"),
        ("viscous_damping@hip", ["damping=0.1,0.2"], "viscous_damping has one value of each parameter"),
    ],
)
def test_lists_that_do_not_fit_are_refused(effect: str, values: list[str], problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        with_effects(load_model("leg"), effect, values, diagnosis=None)


def test_a_list_in_a_model_file_of_an_effect_that_acts_once(tmp_path: Path) -> None:
    _, model = with_effects(load_model("leg"), "viscous_damping@hip", ["damping=0.1"], diagnosis=None)
    file = tmp_path / "damped.toml"
    write_model(model, file)
    text = file.read_text().replace("value = 0.1\nstd = 0.0", "value = [0.1, 0.2]\nstd = [0.0, 0.0]")
    file.write_text(text)
    with pytest.raises(InputError, match="one value of each parameter"):
        load_model(file)


def test_what_takes_one_number_takes_no_list() -> None:
    assert parse_values(["hip=0.2"])["hip"].value == 0.2
    with pytest.raises(InputError, match="not name=value with a number"):
        parse_values(["hip=0.2,0.3"])
