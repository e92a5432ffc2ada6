"""A task of one's own: what it changes is changed, what it cannot is refused, and its bundle knows it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.bundle import read_bundle
from workbench.core import InputError, SimulationError
from workbench.training.draws import Draws
from workbench.training.evaluate import evaluate
from workbench.training.export import export
from workbench.training.learn import learn
from workbench.training.of_bundle import task_of
from workbench.training.randomisation import world_fields
from workbench.training.settings import Learning, Settings
from workbench.training.task_file import posed, read_task
from workbench.training.tasks import TASKS

from .make import machine

_TASK = """
format = 1
base = "reach"
about = "The leg follows slowly."
episode_s = 2.0
posture = [-0.4, 1.2]
command_low = [-0.5, 1.1, 0.1, 0.1, 1, 1, 0, 0]
command_high = [-0.3, 1.3, 0.2, 0.2, 4, 4, 6, 6]
[rewards]
torque2 = -1e-4
action_rate2 = 0
[observations]
joint_velocity = {noise = 0.3}
reach_speed = {leave_out = true}
"""


def test_what_the_file_says_is_changed_and_all_else_is_the_base() -> None:
    task, base = read_task(_TASK, None), TASKS["reach"]
    assert task.episode_s == 2.0 and task.about == "The leg follows slowly."
    weights = {r.name: r.weight for r in task.rewards}
    assert weights["torque2"] == -1e-4 and "action_rate2" not in weights and weights["reach_tracking"] == 1.0
    seen = {o.name: o for o in task.observations}
    assert seen["joint_velocity"].noise == 0.3 and seen["joint_velocity"].scale == 0.1
    assert "reach_speed" not in seen and task.action_scale == base.action_scale
    made = posed(task, machine("leg"))
    assert made.posture.tolist() == [-0.4, 1.2]
    drawn = task.command(Draws(np, 0, np.zeros(1)), 50, made)
    assert drawn.shape == (50, 8) and drawn[:, 4].min() >= 1.0 and drawn[:, 4].max() <= 4.0


def test_a_load_is_drawn_within_the_task_s_range() -> None:
    made = machine("quadruped")
    text = 'format = 1\nbase = "circular"\ntrunk_mass = [2.0, 5.0]\n'
    drawn = read_task(text, None).differences("none")
    trunk = made.mujoco.body("trunk").id
    added = world_fields(made, drawn, 50, 0)["body_mass"][:, trunk] - made.mujoco.body_mass[trunk]
    assert drawn.legs == "none" and 2.0 <= added.min() < 2.5 and 4.5 < added.max() <= 5.0
    with pytest.raises(InputError, match="leave a trunk"):
        world_fields(made, read_task(text.replace("2.0", "-20"), None).differences(), 2, 0)
    for wrong in (text.replace("2.0", "6"), text.replace("circular", "reach")):
        with pytest.raises(InputError, match="not a range of additional mass"):
            read_task(wrong, None)


@pytest.mark.parametrize(
    "old, new, told",
    [
        ('"reach"', '"fly"', "'fly' is not there; choose one of reach"),
        ("torque2", "torqe2", "rewards.torqe2"),
        ("reach_speed", "reach_sped", "observations.reach_sped"),
        ("episode_s = 2.0", "episode_s = -1", "episode_s"),
        ("episode_s", "episodes", "episodes"),
        ("[-0.5, 1.1, 0.1,", "[-0.5, 1.1,", "command_low"),
        ("format = 1", "format =", "is no TOML"),
    ],
)
def test_what_is_wrong_with_it_is_said(old: str, new: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        read_task(_TASK.replace(old, new), Path("mine.toml"))


@pytest.mark.parametrize(
    "posture, told", [("[0.1]", "1 angle for 2 joints"), ("[-0.4, 9.0]", "'knee' is outside its limits")]
)
def test_a_posture_has_to_be_one_of_the_machine(posture: str, told: str) -> None:
    task = read_task(_TASK.replace("[-0.4, 1.2]", posture), None)
    with pytest.raises(InputError, match=told):
        posed(task, machine("leg"))


def _settings(iterations: int) -> Settings:
    return Settings(worlds=8, iterations=iterations, threads=1, save_every=9, learning=Learning(rollout=8))


def test_it_trains_and_its_bundle_is_evaluated_as_that_task(tmp_path: Path) -> None:
    task = read_task(_TASK, None)
    made = posed(task, machine("leg"))
    learn(task, made, _settings(1), tmp_path / "run", extra={"record": None})
    bundle = read_bundle(export(tmp_path / "run", tmp_path / "own.zip"))
    known = task_of(bundle)
    assert known.source == _TASK and known.about == task.about
    result = evaluate(bundle, seconds=1.5)
    np.testing.assert_allclose(result.recording.signals["position_reference"][0], [-0.4, 1.2])


def test_what_falls_at_once_is_refused_after_some_iterations(tmp_path: Path) -> None:
    made = machine("quadruped")
    tall = replace(made, height=made.height / 3.0)  # begins inside of the ground, and on its side it ends
    assert made.lowest == pytest.approx(0.18, abs=1e-4)
    low = type("Low", (type(made),), {"lowest": property(lambda self: 10.0)})
    hopeless = low(**vars(tall))
    with pytest.raises(SimulationError, match=r"cannot be trained: after 5 iterations episodes last 0\.0"):
        learn(TASKS["circular"], hopeless, _settings(9), tmp_path / "run", extra={"record": None})
