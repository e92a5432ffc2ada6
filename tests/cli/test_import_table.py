"""``workbench import`` of a table: it says what it assumed, asks what it cannot tell, and changes nothing."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

from tests.cli.here import run, run_at_a_terminal
from tests.proposing.make import columns, log, mixed, text
from workbench.recordings import load_recording

LOG = log(600)


def torque_in_doubt(folder: Path) -> Path:
    """A log whose torque may be in N m, mN m or N mm."""
    (folder / "run.csv").write_text(text(columns(LOG, tau=1e-3)))
    return folder / "run.csv"


def test_a_recording_is_written_and_read(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(text(columns(LOG), ";", ","))
    before = (tmp_path / "run.csv").read_bytes()
    done = run("import", "run.csv", "--json", "said.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "Wrote run.toml and run.table.csv.gz." in done.stdout and "decimal comma" in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert load_recording(tmp_path / "run.toml").axes == ("hip", "knee")
    assert (tmp_path / "run.csv").read_bytes() == before
    said = json.loads((tmp_path / "said.json").read_text())
    assert said["recording"]["controller"]["kind"] == "pd"
    [made_of] = said["provenance"]["inputs"]
    assert made_of == {"file": "run.csv", "sha256": hashlib.sha256(before).hexdigest()}
    assert all(0 < a["probability"] <= 1 for a in said["assumptions"])
    again = run("import", "run.csv", cwd=tmp_path)
    assert again.returncode == 2 and "--force" in again.stderr
    assert run("inspect", "run.toml", cwd=tmp_path).returncode == 0


def test_a_log_without_a_torque_says_what_would_help(tmp_path: Path) -> None:
    data = {name.replace("torque", "x").replace("cmd", "y"): v for name, v in columns(LOG).items()}
    (tmp_path / "run.csv").write_text(text(data))
    done = run("import", "run.csv", cwd=tmp_path)
    assert done.returncode == 0 and "Not used: y_x_hip" in done.stdout
    assert "--column torque_measured=…,…" in " ".join(done.stdout.split())
    assert "Next: name the torque (--column torque_measured=…) or the gains (--kp, --kd)." in done.stdout


def test_without_a_terminal_one_line_says_what_to_pass(tmp_path: Path) -> None:
    torque_in_doubt(tmp_path)
    done = run("import", "run.csv", cwd=tmp_path)
    assert done.returncode == 2 and len(done.stderr.strip().splitlines()) == 1
    assert "unit of torque" in done.stderr and "--unit torque=" in done.stderr
    assert not (tmp_path / "run.toml").exists()
    done = run("import", "run.csv", "--unit", "torque=Nmm", "-q", cwd=tmp_path)
    assert done.returncode == 0 and done.stdout == ""
    assert np.abs(load_recording(tmp_path / "run.toml").signals["torque_measured"] - LOG.tau).max() < 1e-9


def test_yes_takes_the_likeliest_and_says_that_it_is_a_guess(tmp_path: Path) -> None:
    torque_in_doubt(tmp_path)
    done = run("import", "run.csv", "--yes", cwd=tmp_path)
    assert done.returncode == 0 and "a guess" in done.stdout


def at_a_terminal(folder: Path, answer: str, *words: str) -> str:
    """What is shown where a question is answered; it has to end well."""
    done = run_at_a_terminal(answer, *words, cwd=folder)
    assert done.returncode == 0, done.stdout
    return done.stdout


def test_on_a_terminal_it_asks(tmp_path: Path) -> None:
    torque_in_doubt(tmp_path)
    shown = at_a_terminal(tmp_path, "N*mm", "import", "run.csv")
    assert "unit of torque" in shown and "Wrote run.toml" in shown
    assert np.abs(load_recording(tmp_path / "run.toml").signals["torque_measured"] - LOG.tau).max() < 1e-9


def nameless_order(folder: Path) -> None:
    """A log of hip and knee, and a model that calls its joints otherwise."""
    (folder / "run.csv").write_text(text(columns(LOG)))
    joint = '<joint name="{}" axis="0 1 0"/><geom size="0.1" pos="0 0 -0.2"/>'
    inner = f'<body pos="0 0 -0.2">{joint.format("second")}</body>'
    (folder / "arm.xml").write_text(
        f"<mujoco><worldbody><body>{joint.format('first')}{inner}</body></worldbody></mujoco>"
    )


def test_yes_is_an_answer_to_is_it_so(tmp_path: Path) -> None:
    nameless_order(tmp_path)
    shown = at_a_terminal(tmp_path, "yes", "import", "run.csv", "--model", "arm.xml")
    assert "Is this assignment right" in shown and "Wrote run.toml" in shown
    assert load_recording(tmp_path / "run.toml").axes == ("first", "second")


@pytest.mark.parametrize("wrong", ["n", "nonsense", "first", "first,third"])
def test_what_is_no_answer_is_asked_again_with_what_is_possible(wrong: str, tmp_path: Path) -> None:
    """The other order is no other model: the columns are put in the order of its axes."""
    nameless_order(tmp_path)
    shown = at_a_terminal(tmp_path, f"{wrong}\nsecond,first", "import", "run.csv", "--model", "arm.xml")
    shown = " ".join(shown.split())
    assert ("Then what is it?" if wrong == "n" else f"'{wrong}' is not an answer to that.") in shown
    assert shown.count("give the names first, second in the order of the file's joints") == 2
    made = load_recording(tmp_path / "run.toml")
    assert made.axes == ("first", "second")
    assert np.abs(made.position - LOG.q[:, ::-1]).max() < 1e-9


@pytest.mark.parametrize("wrong", ["furlong", "7", "n"])
def test_a_unit_that_is_none_is_asked_again(wrong: str, tmp_path: Path) -> None:
    torque_in_doubt(tmp_path)
    shown = " ".join(at_a_terminal(tmp_path, f"{wrong}\n3", "import", "run.csv").split())
    assert "Give one of these, by its number or its name." in shown and "Wrote run.toml" in shown
    assert np.abs(load_recording(tmp_path / "run.toml").signals["torque_measured"] - LOG.tau).max() < 1e-9


def test_a_refusal_shows_what_was_worked_out(tmp_path: Path) -> None:
    torque_in_doubt(tmp_path)
    done = run("import", "run.csv", cwd=tmp_path)
    assert done.returncode == 2 and len(done.stderr.strip().splitlines()) == 1
    assert "run.csv: 600 rows; not finished: a question is open" in done.stdout
    assert "pos_hip, pos_knee" in done.stdout and "unit of torque" in done.stdout and "a guess" in done.stdout
    assert run("import", "run.csv", "-q", cwd=tmp_path).stdout == ""


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--column", "position=nowhere,pos_knee"], "nowhere"),
        (["--column", "position"], "NAME=VALUE"),
        (["--unit", "torque=furlong"], "not a unit of torque; e.g. --unit torque=N*m"),
        (["--unit", "torque"], "e.g. --unit position=deg,deg,mm,deg"),
        (
            ["--unit", "position=deg,deg,mm"],
            "3 units of position for 2 axes; give one, or one per axis: --unit",
        ),
        (
            ["--unit", "position=deg", "--unit", "position=rad"],
            "--unit position is given twice; give it once",
        ),
        (["--rate", "-3"], "positive"),
        (["--coordinates", "moon"], "actuator"),
        (["-o", "run.csv"], "does not end in .toml"),
        (["-o", "taken.toml"], "exists"),
        (["--kp", "1", "--kp", "2", "--kp", "3"], "values of --kp"),
    ],
)
def test_wrong_answers_end_in_one_line(tmp_path: Path, words: list[str], said: str) -> None:
    (tmp_path / "run.csv").write_text(text(columns(LOG)))
    (tmp_path / "taken.toml").write_text("")
    done = run("import", "run.csv", *words, cwd=tmp_path)
    assert done.returncode == 2 and said in done.stderr and len(done.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "run.toml").exists()


def test_help_shows_one_unit_an_axis() -> None:
    assert "position=deg,deg,mm,deg" in run("import", "--help", columns=200).stdout


def test_a_log_too_short_is_written_and_said_to_be(tmp_path: Path) -> None:
    whole = mixed(LOG)
    (tmp_path / "run.csv").write_text(text({k: v[300:320] for k, v in whole.items()}))
    done = run("import", "run.csv", cwd=tmp_path, columns=200)
    assert done.returncode == 0, done.stderr
    assert "20 rows, 0.095 s: too short for a comparison. The reference is logged too." in done.stdout
    assert "too few rows to tell" in done.stdout and "Next: import a longer log." in done.stdout
    assert "workbench compare" not in done.stdout and (tmp_path / "run.toml").exists()


def test_what_is_right_is_inspected_before_it_is_compared(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(text(columns(LOG)))
    done = run("import", "run.csv", cwd=tmp_path, columns=200)
    last = done.stdout.strip().splitlines()[-1]
    assert last == "Next: workbench inspect run.toml. Then: workbench compare MODEL run.toml"


def test_a_problem_ends_with_how_to_mend_it(tmp_path: Path) -> None:
    data = mixed(LOG)
    data["A1 drive meas [Nm]"] = -data["A1 drive meas [Nm]"]
    (tmp_path / "run.csv").write_text(text(data))
    done = run("import", "run.csv", cwd=tmp_path, columns=200)
    last = done.stdout.strip().splitlines()[-1]
    assert "problem:" in done.stdout and "workbench compare" not in done.stdout
    assert "{column = 'A1 drive meas [Nm]', scale = -1.0}" in last and last.endswith(
        "workbench inspect run.toml"
    )


def test_a_model_is_not_imported(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text("<mujoco model='arm'><worldbody/></mujoco>")
    done = run("import", "arm.xml", cwd=tmp_path)
    assert done.returncode == 2 and len(done.stderr.strip().splitlines()) == 1
    assert "a model already" in done.stderr and "workbench compare arm.xml RUN.toml" in done.stderr


def test_the_loop_that_a_model_states_is_not_asked_for(tmp_path: Path) -> None:
    data = {name: v for name, v in columns(LOG).items() if "torque" not in name}
    (tmp_path / "run.csv").write_text(text(data))
    done = run("import", "run.csv", "--model", "leg", "--coordinates", "joint", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "the model's" in done.stdout and "--kp" not in done.stdout
    assert "Next: workbench inspect run.toml" in done.stdout
    assert "[controller]" not in (tmp_path / "run.toml").read_text()


def test_which_of_several_runs_is_asked(tmp_path: Path) -> None:
    runs = {n: np.concatenate([v[:200], v[:300], v[:250]]) for n, v in columns(LOG).items()}
    (tmp_path / "run.csv").write_text(text(runs))
    done = run("import", "run.csv", cwd=tmp_path)
    assert done.returncode == 2 and "--episode 1" in done.stderr and not (tmp_path / "run.toml").exists()
    assert run("import", "run.csv", "--episode", "2", cwd=tmp_path).returncode == 0
    assert len(load_recording(tmp_path / "run.toml")) == 250
    done = run("import", "run.csv", "--yes", "--force", cwd=tmp_path)
    assert done.returncode == 0 and "the longest of 3 runs" in done.stdout
