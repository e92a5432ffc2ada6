"""A run that was stopped ends like one that was not; what it leaves behind can be trusted."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import torch

from tests.models.make import leg_in_pieces
from workbench.core import InputError
from workbench.effects import load_model
from workbench.models import load_mjcf
from workbench.training.checkpoint import load
from workbench.training.curve import read_curve
from workbench.training.export import export
from workbench.training.folder import CHECKPOINT, CONFIG, MODEL
from workbench.training.learn import learn
from workbench.training.machine import make_machine
from workbench.training.settings import Settings
from workbench.training.tasks import TASKS

from .make import machine, run


def weights(folder: Path) -> dict[str, torch.Tensor]:
    return load(folder / CHECKPOINT, "cpu")["learner"]["actor_state_dict"]


def test_a_resumed_run_ends_like_one_that_was_never_stopped(tmp_path: Path) -> None:
    told = []
    run(tmp_path / "whole", 6, tell=told.append)
    run(tmp_path / "parts", 4)
    run(tmp_path / "parts", 6, resume=True)
    one, other = weights(tmp_path / "whole"), weights(tmp_path / "parts")
    assert all(torch.equal(one[key], other[key]) for key in one)
    rewards = [[row["reward"] for row in read_curve(tmp_path / name)] for name in ("whole", "parts")]
    assert rewards[0] == rewards[1] and len(rewards[0]) == 6
    assert [p.iteration for p in told] == [1, 2, 3, 4, 5, 6] and told[-1].left_s == 0.0 < told[0].left_s
    assert any((tmp_path / "whole" / "tensorboard").iterdir())


class Stop(Exception):
    pass


def test_a_run_that_is_stopped_loses_one_interval_at_most(tmp_path: Path) -> None:
    def stop(progress) -> None:
        if progress.iteration == 5:
            raise Stop

    with pytest.raises(Stop):
        run(tmp_path / "run", 9, tell=stop)
    assert load(tmp_path / "run" / CHECKPOINT, "cpu")["iteration"] == 4
    run(tmp_path / "run", 6, resume=True)
    run(tmp_path / "whole", 6)
    one, other = weights(tmp_path / "whole"), weights(tmp_path / "run")
    assert all(torch.equal(one[key], other[key]) for key in one)


def test_a_policy_learns_to_reach(tmp_path: Path) -> None:
    settings = Settings(worlds=64, iterations=25, threads=1)
    learn(TASKS["reach"], machine("leg"), settings, tmp_path / "run", extra={"record": None})
    rewards = [row["reward"] for row in read_curve(tmp_path / "run")]
    assert rewards[-1] > rewards[1] + 0.4


def test_the_run_writes_down_what_it_was(tmp_path: Path) -> None:
    run(tmp_path / "run", 1)
    config = json.loads((tmp_path / "run" / CONFIG).read_text())
    assert config["task"] == "reach" and config["settings"]["worlds"] == 16
    assert {"python", "torch", "mujoco", "rsl-rl-lib", "numpy"} <= set(config["versions"])
    assert {"leg.toml", "leg.xml", "leg.sdf"} == set(config["model"]["files"])
    assert all(len(digest) == 64 for digest in config["model"]["files"].values())
    assert sum(entry["size"] for entry in config["observations"]) == 18


def test_the_run_s_model_reads_back_with_all_its_files(tmp_path: Path) -> None:
    model = load_model(leg_in_pieces(tmp_path / "own"))
    leg, settings = make_machine("leg", model, "s3n_full"), Settings(worlds=2, iterations=0, threads=1)
    learn(TASKS["reach"], leg, settings, tmp_path / "run", extra={"record": None})
    shutil.rmtree(tmp_path / "own")
    copied = load_model(tmp_path / "run" / MODEL / "model.toml")
    assert load_mjcf(copied.serial).compile().nmesh == 2
    config = json.loads((tmp_path / "run" / CONFIG).read_text())
    drawn = {"meshes/thin/link.obj", "meshes/wide/link.obj", "parts/option.xml"}
    assert {"model.toml", "leg.xml", *drawn} == set(copied.digests())
    assert {"made.toml", "leg.xml", *drawn} == set(config["model"]["files"])


def test_runs_are_neither_overwritten_nor_mixed(tmp_path: Path) -> None:
    run(tmp_path / "run", 1)
    with pytest.raises(InputError, match="holds a run"):
        run(tmp_path / "run", 1)
    with pytest.raises(InputError, match="began with seed = 0"):
        run(tmp_path / "run", 2, seed=1, resume=True)
    with pytest.raises(InputError, match="no run to continue"):
        run(tmp_path / "nothing", 2, resume=True)
    run(tmp_path / "run", 2, seed=1, force=True)
    assert json.loads((tmp_path / "run" / CONFIG).read_text())["settings"]["seed"] == 1


def test_a_checkpoint_that_carries_code_is_not_run(tmp_path: Path) -> None:
    class Trap:
        def __reduce__(self):
            return os.system, (f"touch {tmp_path / 'sprung'}",)

    torch.save({"iteration": 1, "trap": Trap()}, tmp_path / "trap.pt")
    with pytest.raises(InputError, match="not a checkpoint"):
        load(tmp_path / "trap.pt", "cpu")
    assert not (tmp_path / "sprung").exists()


def test_a_checkpoint_beyond_numbers_is_not_exported(tmp_path: Path) -> None:
    run(tmp_path / "run", 1)
    path = tmp_path / "run" / CHECKPOINT
    for value, says in ((float("nan"), "is not finite"), (3e38, "holds no policy")):
        state = load(path, "cpu")
        for key, weights in state["learner"]["actor_state_dict"].items():
            weights[...] = value if key.endswith("weight") else weights
        torch.save(state, path)
        with pytest.raises(InputError, match=says):
            export(tmp_path / "run", tmp_path / "new.zip")
    assert not (tmp_path / "new.zip").exists()


def test_two_processes_learn_one_policy_and_go_on_with_it(tmp_path: Path) -> None:
    lines = (
        "import sys",
        "sys.path.insert(0, sys.argv[1])",
        "from pathlib import Path",
        "from tests.training.make import run",
        "run(Path(sys.argv[2]), int(sys.argv[3]), resume=sys.argv[3] != '2')",
    )
    (tmp_path / "two.py").write_text("\n".join(lines))
    root = str(Path(__file__).resolve().parents[2])
    launch = [sys.executable, "-m", "torch.distributed.run", "--standalone", "--nproc-per-node", "2"]
    for iterations in ("2", "3"):
        done = subprocess.run(
            [*launch, str(tmp_path / "two.py"), root, str(tmp_path / "run"), iterations],
            capture_output=True, text=True, timeout=120, env={**os.environ, "OMP_NUM_THREADS": "1"},
        )  # fmt: skip
        assert done.returncode == 0, done.stderr[-2000:]
    assert load(tmp_path / "run" / CHECKPOINT, "cpu")["iteration"] == 3
    assert (tmp_path / "run" / "checkpoint.1.pt").exists()
    assert json.loads((tmp_path / "run" / CONFIG).read_text())["processes"] == 2
