"""The runner on a small computer: without Drake, MuJoCo, torch, Pinocchio and all that measures and fits."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.can.make import config, motor, table, written
from tests.deployment.robot import LIMITS, RANGES
from tests.deployment.test_deploy import bundle
from workbench.core import InputError
from workbench.deployment import joints_of
from workbench.deployment.processes import virtual_hardware

ROOT = Path(__file__).resolve().parents[2]
#: What is not on a robot's own computer.
ABSENT = (
    "pydrake", "mujoco", "torch", "pinocchio", "scipy", "numba", "llvmlite", "pyarrow", "pandas",
    "matplotlib", "plotly", "control", "joblib", "pint", "jinja2",
    "threadpoolctl", "asammdf", "rsl_rl", "warp",
)  # fmt: skip
LIGHT = f"""
import sys, time
for name in {ABSENT!r}:
    sys.modules[name] = None
"""


def light(code: str, *words: str, **more) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", LIGHT + code, *words],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=120,
        **more,
    )


def test_it_is_imported_in_under_a_second() -> None:
    code = """
times = []
begin = time.process_time()
import workbench.deployment.deploy, workbench.bundle, workbench.can
print(time.process_time() - begin)
"""
    done = light(code)
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) < 1.0


STATED = {"axes": ["hip", "knee"], "transmission": [[1.0, 0.0], [1.0, 1.0]],
          "limits": [[-1.6, 1.6], [0.35, 2.6]]}  # fmt: skip
MODEL = {"axes": ["hip", "knee"], "model": "leg"}


def leg(folder: Path, mechanism: dict = STATED, **more: object) -> Path:
    motors = [motor(axis, k + 1, limits=LIMITS, ranges=RANGES) for k, axis in enumerate(("hip", "knee"))]
    content = table(motors, mechanism=[mechanism], loop={"soft_start_s": 0.1}, **more)
    content["bus"][0]["channel"] = str(folder / "can0")
    return written(folder, content)


def test_the_program_runs_there(tmp_path: Path) -> None:
    slow, out = {"time_scale": 8.0}, tmp_path / "run.json"
    # the robot knows its transmission, the desk its model; both are on the same bus
    desk = leg(tmp_path, MODEL, bench=slow).rename(tmp_path / "desk.toml")
    path = leg(tmp_path, bench=slow)
    code = "from workbench.cli.app import run; run()"
    with virtual_hardware(desk):
        words = "tracker", str(path), "--yes", "--seconds", "1", "-o", "", "--json", str(out)
        done = light(code, "deploy", *words)
    said = json.loads(out.read_text())
    assert done.returncode == (1 if said["fault"] else 0), done.stderr
    assert said["ticks"] > 20 and "Traceback" not in done.stderr
    dry = light(code, "deploy", "tracker", str(path), "--dry-run")
    assert dry.returncode == 2 and "a dry run needs the whole workbench" in dry.stderr


def test_a_policy_is_read_and_asked_there(tmp_path: Path) -> None:
    code = """
import numpy as np
from workbench.bundle import Policy, read_bundle
policy = Policy(read_bundle(sys.argv[1]))
print(policy(np.zeros(policy.size)).tolist())
"""
    done = light(code, str(bundle(tmp_path)))
    assert done.stdout.strip() == "[0.0, 0.0]", done.stderr


def test_a_stated_transmission_is_that_of_the_model(tmp_path: Path) -> None:
    from workbench.can import load_config

    stated = joints_of(load_config(leg(tmp_path)))
    motors = [motor(axis, k + 1, limits=LIMITS, ranges=RANGES) for k, axis in enumerate(("hip", "knee"))]
    read = joints_of(config(tmp_path, motors, mechanism=[{"model": "leg", "axes": ["hip", "knee"]}]))
    for name in ("matrix", "low", "high"):
        assert getattr(stated, name) == pytest.approx(getattr(read, name))


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({}, "name a model, or write the transmission"),
        ({"transmission": [[1.0, 0.0]]}, "is not a table of 2 rows of 2"),
        ({"transmission": [[1.0, 1.0], [1.0, 1.0]]}, "has no inverse"),
    ],
)
def test_a_transmission_that_is_none_is_refused(tmp_path: Path, more: dict, said: str) -> None:
    motors = [motor(axis, k + 1, limits=LIMITS, ranges=RANGES) for k, axis in enumerate(("hip", "knee"))]
    with pytest.raises(InputError, match=said):
        config(tmp_path, motors, mechanism=[{"axes": ["hip", "knee"], **more}])


def test_the_extra_names_what_the_runner_imports() -> None:
    extra = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]["deploy"]
    named = {re.split(r"[\[<>=]", each)[0] for each in extra}
    code = """
import workbench.deployment.deploy, workbench.cli.deploy, workbench.bundle
import onnx, onnxruntime
before = "cantools" in sys.modules
from workbench.can import Ranges
from workbench.can.odrive import Odrive
Odrive(1, Ranges(1.0, 1.0, 1.0, 1.0, 1.0, "x")).act("clear")
assert not before and "cantools" in sys.modules, "only robots that have such drives wait for it"
print(" ".join({name.partition(".")[0] for name in sys.modules if sys.modules[name] is not None}))
"""
    loaded = set(light(code).stdout.split())
    home = {"can": "python-can", "google": "protobuf"}
    ours = {"numpy", "pydantic", "can", "typer", "onnx", "onnxruntime", "google", "cantools"} & loaded
    assert {home.get(name, name) for name in ours} == named
