"""What is proposed where something stays unexplained fits the place where it sits, and can be made."""

from __future__ import annotations

import re
import shlex
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests.diagnosis.rig import recordings
from workbench.cli.app import app
from workbench.core import Controller, Recording, Share
from workbench.diagnosis.evidence.follow_up import follow_up
from workbench.effects import load_model
from workbench.frf import load_design

LEG = load_model("leg")


@pytest.fixture(scope="module")
def logs() -> list[Recording]:
    return recordings()[0]


def rest(quantity: str, low: float, high: float, signal: str = "torque") -> list[Share]:
    unit = {"speed": "rad/s", "position": "rad", "frequency": "Hz", "time": "s"}[quantity]
    return [Share("knee", signal, quantity, (low, high), unit, 0.4)]


@pytest.mark.parametrize(
    "where, band",
    [
        (rest("frequency", 10.0, 20.0), (8.0, 25.0)),
        (rest("position", 0.4, 0.5), (0.1, 0.6)),
        (rest("speed", -9.0, -7.0), (0.2, None)),
    ],
    ids=["frequency", "position", "speed"],
)
def test_the_command_makes_an_experiment_of_that_band(
    logs: list[Recording], where: list[Share], band: tuple[float, float | None], tmp_path: Path
) -> None:
    said = follow_up(LEG, where, logs)
    command = re.search(r"workbench (excite [^()]*)\)", said)
    assert command is not None and f"{where[0].range[0]:.3g} to {where[0].range[1]:.3g}" in said, said
    words = shlex.split(command[1].replace("next.toml", str(tmp_path / "next.toml")))
    assert CliRunner().invoke(app, words, catch_exceptions=False).exit_code == 0
    low, high = band
    assert words[words.index("--f-min") + 1] == f"{low:g}"
    assert high is None or words[words.index("--f-max") + 1] == f"{high:g}"
    assert load_design(tmp_path / "next.toml").axes == LEG.axes


def test_without_torque_an_experiment_is_as_hard_as_its_loop(logs: list[Recording]) -> None:
    hidden = ("torque_command", "torque_measured")
    silent = [
        replace(r, signals={name: x for name, x in r.signals.items() if name not in hidden}) for r in logs
    ]

    def amplitudes(of: list[Recording]) -> list[float]:
        said = follow_up(LEG, rest("frequency", 10.0, 20.0), of)
        return [float(x) for x in re.findall(r"--amplitude ([0-9.e-]+[0-9])", said)]

    assert amplitudes(silent) == pytest.approx(amplitudes(logs), rel=0.2)


def test_what_is_too_fast_for_the_log_asks_for_a_faster_one(logs: list[Recording]) -> None:
    said = follow_up(LEG, rest("frequency", 300.0, 500.0), logs)
    assert "faster than 1000 rows per second" in said and "excite leg" not in said


def test_what_sits_at_a_time_is_asked_for_again(logs: list[Recording]) -> None:
    said = follow_up(LEG, rest("time", 2.0, 3.0), logs)
    assert "repeat the same run" in said and "workbench excite" not in said


def test_a_machine_without_a_reference_gets_the_advice_alone(logs: list[Recording]) -> None:
    free = replace(LEG, controller=Controller("none"))
    said = follow_up(free, rest("position", 0.4, 0.5), logs)
    assert "slowly" in said and "workbench excite" not in said


def test_where_the_place_is_unknown_all_kinds_are_asked_for(logs: list[Recording]) -> None:
    assert "multisine" in follow_up(LEG, [], logs)
