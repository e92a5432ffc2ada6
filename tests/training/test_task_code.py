"""A task as a Python file: its own terms are learned, and nothing runs code out of a bundle."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tests.cli.here import run
from workbench.bundle import read_bundle
from workbench.core import InputError
from workbench.effects import load_model
from workbench.models import write_model
from workbench.training.task_file import load_task

_TASK = '''
from dataclasses import replace
from workbench.training import REACH, Observation, Reward

def swing(xp, command, time):
    """A sine."""
    angle = 6.0 * time[:, None]
    return command * xp.sin(angle), 6.0 * command * xp.cos(angle)

def miss(s):
    """Joint angles less the sine [rad]."""
    return s.position - s.machine.posture - swing(s.xp, s.command, s.elapsed)[0]

def near(s):
    """exp(-|miss|^2)."""
    return s.xp.exp(-s.xp.sum(s.xp.square(miss(s)), -1))

TASK = replace(
    REACH, name="swing", about="It swings.",
    observations=(*REACH.observations[:2], Observation("miss", miss)),
    rewards=(Reward("near", 1.0, near),),
    command=lambda draws, worlds, m: draws.uniform((0.05,) * m.size, (0.1,) * m.size, (worlds, m.size)),
    numbers=lambda joints: joints, goal=swing, scores=lambda log: {"rows": float(len(log.get("joints")))},
)
'''


def test_it_is_trained_and_evaluated_by_its_file(tmp_path: Path) -> None:
    (tmp_path / "swing.py").write_text(_TASK)
    words = ["--unverified", "--envs", 8, "--iterations", 1, "-o", "run"]
    assert run("train", "swing.py", *words, cwd=tmp_path).returncode == 0
    bundle = read_bundle(tmp_path / "run" / "bundle.zip")
    assert bundle.task == "swing" and bundle.observations[-1].about == "Joint angles less the sine [rad]."
    assert (tmp_path / "run" / "curve.png").read_bytes().startswith(b"\x89PNG")
    evaluate = ["evaluate", "run/bundle.zip", "-o", "out", "--seconds", 1.5]
    alone = run(*evaluate, cwd=tmp_path)
    assert alone.returncode == 2 and "nothing runs code out of a bundle" in alone.stderr
    done = run(*evaluate, "--task", "swing.py", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "rows" in done.stdout
    (tmp_path / "swing.py").write_text(_TASK + "\n")
    other = run(*evaluate, "--task", "swing.py", "--force", cwd=tmp_path)
    assert other.returncode == 2 and "not the file that the policy was trained with" in other.stderr


@pytest.mark.parametrize(
    ("text", "told"),
    [("x = 1\n", "makes no TASK"), ("a = 1\nb = a / 0\n", "row 2"), ("def f(:\n", "SyntaxError")],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path: Path, text: str, told: str) -> None:
    (tmp_path / "bad.py").write_text(text)
    with pytest.raises(InputError, match=told):
        load_task(tmp_path / "bad.py")
    done = run("train", "bad.py", "--unverified", "-o", "run", cwd=tmp_path)
    assert done.returncode == 2 and "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("return s.xp.exp(", "return s.nothing(", "row 16: reward 'near' fails: AttributeError"),
        (
            "s.xp.square(miss(s)), -1))",
            "s.xp.square(miss(s))))",
            "reward 'near' gives an array () in 3 worlds",
        ),
        ("return s.xp.exp(-", "return s.xp.sqrt(-1.0 -", "gives a value that is not a finite number"),
        ("return s.position - s.machine", "return s.position[:, 7] - s.machine", "observation 'miss' fails"),
        ("numbers=lambda joints: joints", "numbers=lambda joints: 9", "command gives an array (3, 2)"),
        ("6.0 * command * xp.cos(angle)", "command[:1]", "speeds of goal gives an array (1, 2)"),
    ],
)
def test_what_its_functions_do_wrong_is_said_before_it_trains(
    tmp_path: Path, old: str, new: str, told: str
) -> None:
    assert old in _TASK
    (tmp_path / "swing.py").write_text(_TASK.replace(old, new))
    words = ["--unverified", "--envs", 4, "--iterations", 1, "-o", "run"]
    done = run("train", "swing.py", *words, cwd=tmp_path)
    assert done.returncode == 2 and told in done.stderr and "swing.py" in done.stderr
    assert not (tmp_path / "run").exists()


def test_terms_without_a_docstring_and_scores_that_fail(tmp_path: Path) -> None:
    bare = _TASK.replace('    """exp(-|miss|^2)."""\n', "").replace('log.get("joints")', 'log.get("toes")')
    (tmp_path / "swing.py").write_text(bare)
    leg = load_model("leg")
    write_model(replace(leg, actuators=replace(leg.actuators, delay_s=0.0)), tmp_path / "prompt.toml")
    words = ["--unverified", "--envs", 4, "--iterations", 1, "-o", "run", "--model", "prompt.toml"]
    done = run("train", "swing.py", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "`deploy` will refuse this policy" in done.stdout and "delay_s = 0.003" in done.stdout
    words = ["evaluate", "run/bundle.zip", "-o", "out", "--seconds", 1.5, "--task", "swing.py"]
    done = run(*words, cwd=tmp_path)
    assert done.returncode == 2 and "scores fails: KeyError: 'toes'" in done.stderr
