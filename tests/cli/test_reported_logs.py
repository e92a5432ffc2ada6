"""Logs as people handed them in, from import to diagnosis: what is wrong with each is named."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.here import run
from tests.data_helpers import report_folder


def imported(folder: Path, log: Path, *more: object, code: int = 0) -> str:
    """What the import of a log says, as one line of words."""
    done = run("import", log, "-o", folder / f"{log.name.split('.')[0]}.toml", *more, columns=200)
    assert done.returncode == code, done.stdout + done.stderr
    return " ".join((done.stdout + done.stderr).split())


@pytest.mark.parametrize(
    ("pair", "named"),
    [
        ("a b", "all columns of 'hip' or all columns of 'knee'; the data cannot tell which"),
        ("ao bo", "torque of 'knee'"),
        ("am bm", "position and velocity of 'knee'"),
    ],
)
def test_signs(tmp_path: Path, pair: str, named: str) -> None:
    logs = report_folder("signs")
    for name in pair.split():
        said = imported(tmp_path, logs / f"{name}.csv.gz", "--model", logs / "leg.xml")
        assert named in said and "Next: negate the columns with the wrong sign" in said
    first, second = (tmp_path / f"{name}.toml" for name in pair.split())
    told = run("diagnose", logs / "leg.xml", first, "--holdout", second, cwd=tmp_path)
    assert told.returncode == 2 and named in told.stderr
    beside = run("compare", logs / "leg.xml", first, "--json", "-", cwd=tmp_path)
    assert beside.returncode == 0 and any(named in note for note in json.loads(beside.stdout)["notes"])


def test_units_that_no_number_tells(tmp_path: Path) -> None:
    logs = report_folder("units_sure")
    for name in ("motA", "motB"):
        said = imported(tmp_path, logs / f"{name}.csv.gz", code=2)
        assert "needs an answer. What is the unit of position: rad or deg or turn" in said
        said = imported(tmp_path, logs / f"{name}.csv.gz", "--model", logs / "leg.xml")
        assert "turn sure the model's weight and inertia" in said
        imported(tmp_path, logs / f"{name}.csv.gz", "--yes", "--force")
    told = run("diagnose", logs / "leg.xml", tmp_path / "motA.toml", "--holdout", tmp_path / "motB.toml")
    assert told.returncode == 2 and "possible unit error" in told.stderr
    assert "revolutions and radians" in told.stderr


def test_a_factor_of_ten_a_range_s_parts_and_currents_are_asked(tmp_path: Path) -> None:
    logs = report_folder("units_sure")
    ten = imported(tmp_path, logs / "tenA.csv.gz", code=2)
    assert "Velocity is 10 times the derivative of position" in ten and "velocity=0.1*rad/s" in ten
    assert "scaled to each joint's range" in imported(tmp_path, logs / "lerobot_ds", code=2)
    named = ("--column", "torque_measured=hip_current,knee_current")
    asked = imported(tmp_path, logs / "amperes.csv.gz", *named, code=2)
    assert "What is the torque constant of each drive" in asked
    assert "N m per A" in imported(tmp_path, logs / "amperes.csv.gz", *named, "--unit", "torque=A", code=2)
    imported(tmp_path, logs / "amperes.csv.gz", *named, "--unit", "torque=1.27*N*m,1.1*N*m")


def test_drives_that_go_dead(tmp_path: Path) -> None:
    logs = report_folder("drives_off")
    for name in ("estop", "estopf", "fine"):
        said = imported(tmp_path, logs / f"{name}.csv.gz", "--model", logs / "leg.xml")
        assert ("From 6 s on the drives give no torque" in said) == (name != "fine")
    assert run("compare", logs / "leg.xml", "estop.toml", cwd=tmp_path).stdout.startswith(
        "The model explains"
    )
    told = run("diagnose", logs / "leg.xml", "estopf.toml", "--holdout", "fine.toml", cwd=tmp_path)
    assert "Coulomb friction on the hip drive, 0.19" in told.stdout or "0.20" in told.stdout
    assert "Something is missing" in told.stdout


@pytest.mark.parametrize(
    ("log", "model", "friction"),
    [("wrap2pi", "leg", "0.24"), ("wheel", "wheel", "0.080"), ("wheel12", "wheel", "0.080")],
)
def test_encoders_that_wrap(tmp_path: Path, log: str, model: str, friction: str) -> None:
    logs = report_folder("wrap")
    said = imported(tmp_path, logs / f"{log}.csv.gz", "--model", logs / f"{model}.xml")
    assert "jumps by its whole range of" in said and "controller pd" in said
    told = run("diagnose", logs / f"{model}.xml", tmp_path / f"{log}.toml")
    assert f"Coulomb friction on the {'hip' if model == 'leg' else 'wheel'} drive, {friction}" in told.stdout


def test_the_loop_that_a_log_shows(tmp_path: Path) -> None:
    logs = report_folder("loop_of_the_log")
    seen = " ".join(run("inspect", logs / "aw.toml", columns=200).stdout.split())
    law = "in joint coordinates the logged command follows the stated law"
    assert f"{law} (less than 0.001 % of it remains unexplained)" in seen
    told = run("diagnose", logs / "own.toml", logs / "afw.toml", "--holdout", logs / "bfw.toml")
    assert told.returncode == 2 and 'write coordinates = "joint"' in told.stderr
    said = imported(tmp_path, logs / "lowcmd.csv.gz", "--model", logs / "leg.xml")
    assert "controller pd, kp 25, 30; kd 0.6, 0.8" in said and "Not used" not in said
    said = imported(tmp_path, logs / "target.csv.gz")
    assert "position_reference j_target" in said and "controller pd, kp 40; kd 0.3" in said
