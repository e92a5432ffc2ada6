"""One limb of a whole robot goes the whole way by the commands of the docs: file, policy, and back."""

from __future__ import annotations

import json
from hashlib import sha256
from pathlib import Path

import pytest

from tests.biped import biped
from tests.can.make import motor, table, written
from tests.cli.here import run
from workbench.bundle import read_bundle
from workbench.comparison import compare
from workbench.deployment.processes import virtual_hardware
from workbench.effects import load_model
from workbench.recordings import load_recordings

_TASK = """format = 1
base = "reach"
action_scale = 0.2
hidden = [16]
iterations = 2
posture = [0.55]
command_low = [0.5, 0.05, 1, 0]
command_high = [0.6, 0.1, 6, 6]
"""


@pytest.fixture(scope="module")
def limb(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a biped, the model of its left ankle, and a policy of two iterations."""
    folder = tmp_path_factory.mktemp("limb")
    words = ["--drive", "left_ankle", "--joint", "left_ankle", "--start", "left_ankle=0.4", "--hold-rest"]
    loop = ["--kp", 30, "--kd", 1.5, "--delay", 0.003, "--period", 0.003]
    assert run("import", biped(folder), *words, *loop, "-o", "own.toml", cwd=folder).returncode == 0
    (folder / "mine.toml").write_text(_TASK)
    return folder


def test_its_experiments_find_what_is_hidden_in_it(limb: Path) -> None:
    plan = ["--period", 1.2, "--periods", 1, "--amplitude", 1.0, "--posture", "left_ankle=0.55"]
    assert run("excite", "own.toml", "-o", "plan.toml", *plan, cwd=limb).returncode == 0
    hide = ["--hide", "viscous_damping@left_ankle", "--set", "damping=0.2"]
    done = run("demo", "own.toml", "plan.toml", "-o", "found", *hide, cwd=limb)
    assert done.returncode == 0, done.stderr
    said = " ".join(done.stdout.split())
    assert "Viscous damping on the left_ankle drive" in said and "found damping" in said, said
    assert "reference leg" not in said


def test_it_is_normalised_for_three_targets(limb: Path) -> None:
    for target in ("mujoco3", "mjlab", "urdf"):
        out = ["-o", f"limb.{target}.xml", "--for", target, "--json", f"{target}.json", "--quiet"]
        done = run("normalize", "own.toml", *out, cwd=limb)
        assert done.returncode == 0, done.stderr
        lost = json.loads((limb / f"{target}.json").read_text())["for"]["lost"]
        assert all("e-1" not in each for each in lost), lost


def test_its_policy_comes_back_as_recordings_that_it_explains(limb: Path) -> None:
    done = run(
        "train", "mine.toml", "--model", "own.toml", "--unverified", "--envs", 8, "-o", "run", cwd=limb
    )
    assert done.returncode == 0, done.stderr
    done = run("evaluate", "run/bundle.zip", "--seconds", 1.5, "-o", "evaluated", cwd=limb)
    assert done.returncode == 0 and "the closed chain of" in done.stdout, done.stderr
    done = run("show", "run/bundle.zip", "--seconds", 1.5, "-o", "page.html", cwd=limb)
    assert done.returncode == 0, done.stderr
    assert "Trained in a tree fitted to its loops" in (limb / "page.html").read_text()
    _robot(limb)
    done = run("deploy", "run/bundle.zip", "robot.toml", "--dry-run", "--seconds", 3, "-o", "kept", cwd=limb)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "in Drake, 1 drive (left_ankle)" in " ".join(done.stderr.split())
    for file, most in (("evaluated/hardware", 1.1), ("evaluated/simulation", 1.1), ("kept/run", 1.3)):
        assert _times_the_noise(limb, file) < most, file


def test_its_policy_comes_back_over_the_virtual_bus_too(limb: Path) -> None:
    """Bus, drives and loop are processes, ten times slower than real time."""
    if not (limb / "run" / "bundle.zip").is_file():
        words = ["--unverified", "--envs", 8, "-o", "run"]
        assert run("train", "mine.toml", "--model", "own.toml", *words, cwd=limb).returncode == 0
    config = _robot(limb)
    words = ["--yes", "--watchdogs-tested", "--unapproved", "--seconds", 2, "-o", "bus", "--force"]
    left, done = 3, None
    while left and (done is None or "no feedback" in done.stdout):
        # a busy machine may hold the loop up for longer than its limit
        left -= 1
        with virtual_hardware(config):
            done = run("deploy", "run/bundle.zip", "robot.toml", *words, cwd=limb)
    assert done is not None
    assert done.returncode == 0, done.stdout + done.stderr
    assert _times_the_noise(limb, "bus/run") < 1.5


def _robot(folder: Path) -> Path:
    """The configuration of the limb's drive, for the machine that its policy was trained for."""
    limits = {"position": [-3.0, 3.0], "velocity": 40.0, "torque": 20.0}
    ranges = {"position": 12.5, "velocity": 45.0, "torque": 24.0, "source": "label of the drive"}
    motors = [motor("left_ankle", 1, limits=limits, ranges=ranges)]
    loop = {"period_s": 0.003, "kp": 30.0, "kd": 1.5, "policy_every": 6}
    mechanism = [{"axes": ["left_ankle"], "joints": ["left_ankle"], "model": str(folder / "own.toml")}]
    machine = sha256(read_bundle(folder / "run" / "bundle.zip").machine.encode()).hexdigest()[:16]
    content = table(motors, loop=loop, mechanism=mechanism, machine=machine, bench={"time_scale": 10.0})
    content["bus"][0]["channel"] = str(folder / "can0")
    return written(folder, content)


def _times_the_noise(folder: Path, file: str) -> float:
    result = compare(load_model(folder / "own.toml"), load_recordings([folder / f"{file}.toml"]))
    return result.error / result.noise_error
