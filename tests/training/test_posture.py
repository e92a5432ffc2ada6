"""A limb whose transmission changes goes the whole way: task, policy, its closed chain, the bus, and back."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.can.make import motor, table, written
from tests.cli.here import run
from workbench.bundle import read_bundle
from workbench.comparison import compare
from workbench.core import InputError
from workbench.effects import load_model
from workbench.models import read_model
from workbench.recordings import load_recordings
from workbench.s3n import PostureDependent, drive_map
from workbench.training.machine import make_machine

_TASK = 'format = 1\nbase = "reach"\naction_scale = 0.2\nhidden = [16]\niterations = 2\n'
_AXES = "left", "right"


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the shipped ankle as one's own, and a policy of two iterations."""
    folder = tmp_path_factory.mktemp("ankle")
    models = Path(__file__).parents[2] / "models"
    text = (models / "ankle.toml").read_text().replace("0.002", "0.003")  # whole control steps
    for part in ("serial/ankle.xml", "closed_chain/ankle.sdf"):
        (folder / part).parent.mkdir()
        (folder / part).write_text((models / part).read_text())
    (folder / "ankle.toml").write_text(text)
    (folder / "mine.toml").write_text(_TASK)
    words = ["--model", "ankle.toml", "--unverified", "--envs", 8, "-o", "run"]
    done = run("train", "mine.toml", *words, cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder


def test_polynomials_are_where_the_closed_chain_has_its_drives() -> None:
    model = read_model("ankle")
    chain = PostureDependent(model)
    found = drive_map(model, chain)
    assert found is not None and drive_map(read_model("leg")) is None
    q = np.random.default_rng(0).uniform(*chain.box.T, (40, 2))
    at = chain.at(q)
    np.testing.assert_allclose(found.drives(q), at.drives, atol=2e-6)
    np.testing.assert_allclose(found.jacobian(q), at.jacobian, atol=2e-4)


def test_it_has_no_variants_and_no_quadruped() -> None:
    with pytest.raises(InputError, match="no quadruped is made of it"):
        make_machine("quadruped", read_model("ankle"))


def test_its_policy_runs_in_its_chain_and_compare_takes_it(trained: Path) -> None:
    bundle = read_bundle(trained / "run" / "bundle.zip")
    assert bundle.control.map is not None
    words = "--seconds", 1.5, "--json", "told.json"
    done = run("evaluate", "run/bundle.zip", "-o", "evaluated", *words, cwd=trained)
    assert done.returncode == 0, done.stderr
    assert "the closed chain of ankle.sdf" in done.stdout
    assert "trained in a tree fitted to its loops" in done.stdout
    assert json.loads((trained / "told.json").read_text())["trained_in"] == "a tree fitted to its loops"
    for name in ("hardware", "simulation"):
        recordings = load_recordings([trained / "evaluated" / f"{name}.toml"])
        assert recordings[0].name == f"reach_fitted_{name}"
        result = compare(load_model(trained / "ankle.toml"), recordings)
        assert result.consistent and result.error < 1.1 * result.noise_error


def test_limits_that_no_plain_tree_fits_are_refused(trained: Path) -> None:
    near = (trained / "ankle.toml").read_text()
    assert "limits = [[-0.5, 0.4], [-0.25, 0.25]]" in near
    wide = near.replace("limits = [[-0.5, 0.4], [-0.25, 0.25]]", "limits = [[-0.9, 0.9], [-0.4, 0.4]]")
    (trained / "wide.toml").write_text(wide)
    with pytest.raises(InputError, match="narrow the limits") as raised:
        make_machine("leg", read_model(trained / "wide.toml"))
    assert "--allow-error" not in str(raised.value)


def test_it_is_deployed_over_the_virtual_bus_and_recorded(trained: Path) -> None:
    bundle = read_bundle(trained / "run" / "bundle.zip")
    limits = {"position": [-3.0, 3.0], "velocity": 40.0, "torque": 20.0}
    ranges = {"position": 12.5, "velocity": 45.0, "torque": 24.0, "source": "label of the drive"}
    motors = [motor(axis, k + 1, limits=limits, ranges=ranges) for k, axis in enumerate(_AXES)]
    loop = {"period_s": 0.003, "kp": [60.0, 40.0], "kd": [1.5, 1.0], "policy_every": 6}
    from hashlib import sha256

    digest = sha256(bundle.machine.encode()).hexdigest()[:16]
    mechanism = [
        {"axes": list(_AXES), "joints": list(bundle.control.joints), "model": str(trained / "ankle.toml")}
    ]
    written(trained, table(motors, loop=loop, mechanism=mechanism, machine=digest))
    done = run(
        "deploy", "run/bundle.zip", "robot.toml", "--dry-run", "--seconds", 3, "-o", "kept", cwd=trained
    )
    assert done.returncode == 0, done.stdout + done.stderr
    (log,) = load_recordings([trained / "kept" / "run.toml"])
    result = compare(load_model(trained / "ankle.toml"), [log])
    assert result.error < 1.3 * result.noise_error


def test_what_is_missing_at_a_drive_is_found_and_trained_with(trained: Path) -> None:
    hidden = ["--hide", "viscous_damping@left", "--set", "damping=0.2"]
    plan = ["--period", 1.8, "--periods", 1, "--amplitude", 2]
    assert run("excite", "ankle.toml", "-o", "plan.toml", *plan, cwd=trained).returncode == 0
    made = run("record", "ankle.toml", "plan.toml", "-o", "data", "--virtual", *hidden, cwd=trained)
    assert made.returncode == 0, made.stderr
    files = sorted((trained / "data").glob("*.toml"))
    result = compare(load_model(trained / "ankle.toml"), load_recordings(files))
    assert not result.consistent and result.error > 1.5 * result.noise_error
    done = run("improve", "ankle.toml", *files, "-o", "better.toml", "--json", "found.json", cwd=trained)
    assert done.returncode == 0, done.stderr
    (step,) = json.loads((trained / "found.json").read_text())["steps"]
    found = step["parameters"]["damping"]
    assert (step["effect"], step["axis"]) == ("viscous_damping", "left")
    assert abs(found["value"] - 0.2) < 3.0 * found["std"] < 0.02
    assert make_machine("leg", load_model(trained / "better.toml")).left_out == ()
