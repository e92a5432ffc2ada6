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


def test_its_policy_comes_back_as_recordings_that_its_model_explains(limb: Path) -> None:
    done = run(
        "train", "mine.toml", "--model", "own.toml", "--unverified", "--envs", 8, "-o", "run", cwd=limb
    )
    assert done.returncode == 0, done.stderr
    done = run("evaluate", "run/bundle.zip", "--seconds", 1.5, "-o", "evaluated", cwd=limb)
    assert done.returncode == 0 and "the closed chain of" in done.stdout, done.stderr
    limits = {"position": [-3.0, 3.0], "velocity": 40.0, "torque": 20.0}
    ranges = {"position": 12.5, "velocity": 45.0, "torque": 24.0, "source": "label of the drive"}
    motors = [motor("left_ankle", 1, limits=limits, ranges=ranges)]
    loop = {"period_s": 0.003, "kp": 30.0, "kd": 1.5, "policy_every": 6}
    mechanism = [{"axes": ["left_ankle"], "joints": ["left_ankle"], "model": str(limb / "own.toml")}]
    machine = sha256(read_bundle(limb / "run" / "bundle.zip").machine.encode()).hexdigest()[:16]
    written(limb, table(motors, loop=loop, mechanism=mechanism, machine=machine))
    done = run("deploy", "run/bundle.zip", "robot.toml", "--dry-run", "--seconds", 3, "-o", "kept", cwd=limb)
    assert done.returncode == 0, done.stdout + done.stderr
    model = load_model(limb / "own.toml")
    for file, most in (("evaluated/hardware", 1.1), ("evaluated/simulation", 1.1), ("kept/run", 1.3)):
        result = compare(model, load_recordings([limb / f"{file}.toml"]))
        assert result.error < most * result.noise_error, file
