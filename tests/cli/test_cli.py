"""The program as a user runs it: outputs, exit codes, one clear line for each mistake."""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import tomli_w

from tests.cli.here import run
from workbench.effects import load_model
from workbench.recordings import save_recording
from workbench.rigs import HiddenEffect, VirtualLeg, chirp, validation


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two short recordings of a leg with a bias on the knee drive."""
    folder = tmp_path_factory.mktemp("data")
    leg = VirtualLeg([HiddenEffect("torque_bias", "knee", parameters={"torque": 0.5})], seed=4)
    for recording in leg.run([chirp("knee", duration=3.0), validation(2, duration=2.0)]):
        save_recording(recording, folder / f"{recording.name}.toml")
    return folder


def test_the_loop_from_compare_to_compare(data: Path, tmp_path: Path) -> None:
    chirp_file, judge = data / "chirp_knee.toml", data / "validation.toml"
    before = run("compare", "leg", chirp_file, judge, "--json", "-")
    assert before.returncode == 0, before.stderr
    first = json.loads(before.stdout)
    assert first["format"] == 1 and first["error"] > 1.5 * first["noise_error"]

    told = run("diagnose", "leg", chirp_file, "--holdout", judge, "--json", tmp_path / "d.json")
    assert told.returncode == 0, told.stderr
    finding = json.loads((tmp_path / "d.json").read_text())
    assert finding["verdict"] == "missing_effect"
    assert (finding["findings"][0]["effect"], finding["findings"][0]["axis"]) == ("torque_bias", "knee")

    added = run("add", "leg", "--from", tmp_path / "d.json", "-o", tmp_path / "new.toml")
    assert added.returncode == 0, added.stderr
    after = json.loads(run("compare", tmp_path / "new.toml", chirp_file, judge, "--json", "-").stdout)
    assert after["error"] < 1.1 * after["noise_error"]

    better = run(
        "improve", "leg", chirp_file, "--holdout", judge, "-o", tmp_path / "better.toml", "--json", "-"
    )
    steps = json.loads(better.stdout)
    assert [s["effect"] for s in steps["steps"]] == ["torque_bias"] and steps["verdict"] == "consistent"
    (tmp_path / "steps.json").write_text(better.stdout)
    wrong = run("add", "leg", "--from", tmp_path / "steps.json", "-o", tmp_path / "other.toml")
    assert wrong.returncode == 2 and "the JSON of an improvement" in wrong.stderr
    confirmed = json.loads(run("compare", tmp_path / "better.toml", chirp_file, "--json", "-").stdout)
    assert confirmed["error"] == pytest.approx(steps["error_after"], rel=1e-6)


def test_answers_of_no_end_with_one(data: Path) -> None:
    for above, code in (("0.001", 1), ("10", 0)):
        assert run("compare", "leg", data / "validation.toml", "--fail-above", above, "-q").returncode == code


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("compare", "no_such_model", "{data}/chirp_knee.toml"), "no such model file"),
        (("compare", "leg", "{data}/nothing.toml"), "nothing.toml"),
        (("compare", "emps", "{data}/chirp_knee.toml"), "axis 'hip' is not one of model 'emps'"),
        (("compare", "leg", "{data}/chirp_knee.toml", "{data}/chirp_knee.toml"), "given twice"),
        (("add", "leg", "magic@knee", "-o", "x.toml"), "no effect is called 'magic'"),
        (("add", "leg", "coulomb_friction@elbow", "torque=1", "-o", "x.toml"), "coulomb_friction@hip"),
        (("add", "leg", "coulomb_friction@knee", "torque=nan", "-o", "x.toml"), "torque=nan"),
        (("add", "leg", "coulomb_friction@knee", "torque=-1", "-o", "x.toml"), "outside"),
        (("add", "leg", "coulomb_friction@knee", "-o", "x.toml"), "needs the parameter 'torque'"),
        (("add", "leg", "coulomb_friction@knee", "torque=1"), "-o NEW"),
        (("record", "arm", "-o", "out"), "the built-in rigs are 'leg', 'leg_on_plate' and 'actuator'"),
        (("record", "leg", "dance", "-o", "out"), "no experiment is called 'dance'"),
    ],
)
def test_mistakes_end_in_one_line_and_two(
    words: tuple[str, ...], says: str, data: Path, tmp_path: Path
) -> None:
    done = run(*(w.format(data=data) for w in words), cwd=tmp_path)
    assert done.returncode == 2
    assert says in done.stderr and "Traceback" not in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_it_is_a_program(data: Path, tmp_path: Path) -> None:
    words = [sys.executable, "-m", "workbench.cli", "compare", "leg", str(data / "chirp_knee.toml")]
    done = subprocess.run([*words, "--json", "out.json"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "chirp_knee" in done.stdout and json.loads((tmp_path / "out.json").read_text())["model"] == "leg"


def test_nothing_is_overwritten_unasked(tmp_path: Path) -> None:
    words = ("add", "leg", "torque_bias@hip", "torque=0.1", "-o", tmp_path / "m.toml")
    done = run(*words)
    assert done.returncode == 0 and done.stdout.endswith("leg with torque bias on the hip drive.\n")
    load = run("add", "leg", "payload_mass", "mass=0.1", "-o", tmp_path / "load.toml")
    assert load.stdout.endswith("leg with payload mass at site 'foot'.\n")
    first = (tmp_path / "m.toml").read_text()
    again = run(*words)
    assert again.returncode == 2 and "--force" in again.stderr
    assert run(*words, "--force").returncode == 0
    assert (tmp_path / "m.toml").read_text() == first


def test_inspect_sees_swapped_columns(data: Path, tmp_path: Path) -> None:
    assert run("inspect", data / "chirp_knee.toml").returncode == 0
    description = tomllib.loads((data / "chirp_knee.toml").read_text())
    description["columns"]["velocity"].reverse()
    wrong = data / "wrong.toml"
    wrong.write_text(tomli_w.dumps(description))
    done = run("inspect", wrong, "--json", tmp_path / "i.json")
    assert done.returncode == 1
    assert "swap" in (tmp_path / "i.json").read_text()


def test_add_takes_over_what_a_diagnosis_settled_of_the_model(tmp_path: Path) -> None:
    finding = {"effect": "coulomb_friction", "axis": "knee", "location": "actuator"}
    finding["parameters"] = {"torque": {"value": 0.25, "std": 0.001, "unit": "N*m"}}
    diagnosis = {"findings": [finding], "settled": {"sliding_speed": 0.02, "full_braking": 1.0}}
    (tmp_path / "d.json").write_text(json.dumps(diagnosis))
    new = tmp_path / "new.toml"
    assert run("add", "leg", "--from", tmp_path / "d.json", "-o", new).returncode == 0
    model = load_model(new)
    assert model.sliding_speed == 0.02 and not model.actuators.full_braking, "no speed limit was added"
    finding["parameters"]["torque"]["std"] = None  # JSON has no infinity
    (tmp_path / "d.json").write_text(json.dumps(diagnosis))
    assert run("add", "leg", "--from", tmp_path / "d.json", "-o", tmp_path / "open.toml").returncode == 0
    assert load_model(tmp_path / "open.toml").effects[-1].parameters["torque"].std == float("inf")
    (tmp_path / "d.json").write_text(json.dumps({**diagnosis, "settled": {"sliding_speed": "fast"}}))
    refused = run("add", "leg", "--from", tmp_path / "d.json", "-o", new, "--force")
    assert refused.returncode == 2 and "settled" in refused.stderr
