"""What a logger is told while a policy learns, and what is said of one that cannot be used."""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from tests.cli.here import run
from workbench.core import InputError
from workbench.training.curve import Curve
from workbench.training.curve_file import read_curve
from workbench.training.loggers import check_logger, make_logger

ROWS = {1: {"reward": 1.5, "term_speed": 0.25}, 2: {"reward": 2.5, "term_speed": 0.5}}


def learned(folder: Path, name: str, done: int = 0) -> None:
    """Two iterations, written down."""
    curve = Curve(folder, done, make_logger(name, folder, done, {"task": "reach"}))
    for iteration, values in ROWS.items():
        curve.add(done + iteration, values)
    curve.flush()
    curve.close()


def test_tensorboard_has_the_numbers_of_the_csv_file(tmp_path: Path) -> None:
    learned(tmp_path, "tensorboard")
    reader = import_module("tensorboard.backend.event_processing.event_accumulator")  # comes with rsl_rl
    events = reader.EventAccumulator(str(tmp_path / "tensorboard"))
    events.Reload()
    assert [(e.step, e.value) for e in events.Scalars("term/speed")] == [(1, 0.25), (2, 0.5)]
    assert [row["reward"] for row in read_curve(tmp_path)] == [1.5, 2.5]


def test_without_a_logger_the_csv_file_is_there(tmp_path: Path) -> None:
    learned(tmp_path, "none")
    assert [row["iteration"] for row in read_curve(tmp_path)] == [1.0, 2.0]
    assert not (tmp_path / "tensorboard").exists()


def test_weights_and_biases_is_told_each_row_and_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the calls that the package wandb documents: init, log, finish."""
    begun: list[dict[str, Any]] = []
    told: list[Any] = []

    def init(**given: Any) -> SimpleNamespace:
        begun.append(given)

        def log(values: dict[str, float], step: int) -> None:
            told.append((step, values))

        return SimpleNamespace(id=given["id"] or "a1b2", log=log, finish=lambda: told.append("finished"))

    package = ModuleType("wandb")
    package.init = init  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "wandb", package)
    learned(tmp_path, "wandb")
    rows = [(1, {"reward": 1.5, "term/speed": 0.25}), (2, {"reward": 2.5, "term/speed": 0.5})]
    assert told == [*rows, "finished"]
    learned(tmp_path, "wandb", done=2)
    assert [b["id"] for b in begun] == [None, "a1b2"]
    assert begun[0]["config"] == {"task": "reach"}


def test_a_logger_that_cannot_be_used_is_refused_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="choose one of tensorboard, wandb, none"):
        check_logger("neptune")
    monkeypatch.setitem(sys.modules, "wandb", None)
    with pytest.raises(InputError, match="needs the package wandb; install it"):
        check_logger("wandb")


@pytest.mark.parametrize(
    ("words", "says"),
    [(("--logger", "nope"), "no logger is called 'nope'"), (("--legs", "nope"), "no range is called 'nope'")],
)
def test_a_wrong_name_is_refused_before_torch_is_loaded(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, words: tuple[str, ...], says: str
) -> None:
    monkeypatch.setitem(sys.modules, "workbench.training.device", None)
    ended = run("train", "reach", *words, "-o", "run", cwd=tmp_path)
    assert ended.returncode == 2 and says in ended.stderr
