"""``compare --gait`` on a shipped policy's recordings: table, JSON, and a plain line for what is lacking."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from tests.cli.here import run
from workbench.bundle import read_bundle
from workbench.core.files import write_all
from workbench.recordings import load_recording, save_recording
from workbench.training.evaluate import evaluate
from workbench.training.of_bundle import robot_files

POLICIES = Path(__file__).resolve().parents[2] / "policies"


@pytest.fixture(scope="module")
def walked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("walked")
    bundle = read_bundle(POLICIES / "circular_s3n_full.zip")
    for name, options in (
        ("hardware", {}), ("again", {"seed": 1}), ("simulation", {"hardware": False}),
    ):  # fmt: skip
        save_recording(evaluate(bundle, seconds=4.0, **options).recording, folder / f"{name}.toml")
    write_all(robot_files(bundle, folder))
    return folder


def test_every_measure_of_a_policy_s_run(walked: Path) -> None:
    words = ["compare", "robot.toml", "hardware.toml", "--gait", "simulation.toml", "--again", "again.toml"]
    made = run(*words, "--command", "0.8,0.8", "--from", "1", "--json", "gait.json", cwd=walked)
    assert made.returncode == 0 and "stride frequency [%]" in made.stdout
    content = json.loads((walked / "gait.json").read_text())
    found = {m["name"]: m for m in content["measures"]}
    assert content["lacking"] == [] and content["format"] == 1
    assert found["E_phi"]["floor"]["value"] < found["E_phi"]["gap"]["value"]
    assert found["swing leg's knee"]["gap"]["high"] < 10.0  # S3N-Full on its own hardware
    assert found["stride frequency"]["hardware"]["value"] == pytest.approx(2.65, abs=0.2)


def test_what_a_recording_lacks_is_one_line_the_rest_is_made(walked: Path) -> None:
    log = load_recording(walked / "hardware.toml")
    extra = {name: values for name, values in log.extra.items() if name != "ground_force"}
    save_recording(replace(log, extra=extra), walked / "blind.toml")
    made = run("compare", "robot.toml", "blind.toml", "--gait", "simulation.toml", "--from", "1", cwd=walked)
    assert made.returncode == 2 and "swing leg's knee" in made.stdout
    [line] = [x for x in made.stderr.splitlines() if x]
    assert "the duty factor needs ground_force" in line and "Traceback" not in line


def test_options_that_do_not_go_together(walked: Path) -> None:
    for words, said in (
        (["--again", "again.toml"], "belong to --gait"),
        (["--gait", "simulation.toml", "--html", "x.html"], "table and JSON"),
        (["--gait", "simulation.toml", "--command", "fast"], "is not two numbers"),
    ):
        made = run("compare", "robot.toml", "hardware.toml", *words, cwd=walked)
        assert made.returncode == 2 and said in made.stderr
