"""A run on a disk that fails at any call: there is a checkpoint to go on with, and a line names a file."""

from __future__ import annotations

import shutil
from pathlib import Path

from tests.disk import Disk, files, sweep
from workbench.core import WorkbenchError
from workbench.training.checkpoint import load
from workbench.training.curve import read_curve
from workbench.training.folder import CHECKPOINT, CONFIG, MJCF

from .make import run


def fails(disk: Disk, iterations: int, **others) -> WorkbenchError | None:
    """What a run ends with on this disk."""
    with disk:
        try:
            run(disk.folder / "run", iterations, **others)
        except WorkbenchError as error:
            return error
    return None


def test_a_run_that_goes_on_keeps_its_checkpoint_and_curve(tmp_path: Path) -> None:
    run(tmp_path / "before", 2)
    for disk in sweep(tmp_path):
        folder = disk.folder / "run"
        shutil.copytree(tmp_path / "before", folder)
        error = fails(disk, 4, resume=True)
        assert error is None or (error.exit_code and str(folder) in str(error)), error
        done = load(folder / CHECKPOINT, "cpu")["iteration"]
        assert done in (2, 4) and (error is not None or done == 4)
        rows = [row["iteration"] for row in read_curve(folder)]
        assert rows[:done] == list(range(1, done + 1)), "no row of what the checkpoint has done is missing"


def test_a_run_begun_anew_keeps_the_old_one_until_written(tmp_path: Path) -> None:
    run(tmp_path / "before", 2)
    old = files(tmp_path / "before")
    for disk in sweep(tmp_path):
        folder = disk.folder / "run"
        shutil.copytree(tmp_path / "before", folder)
        error = fails(disk, 2, seed=1, force=True)
        assert error is None or (error.exit_code and str(folder) in str(error)), error
        begun = (folder / CONFIG).read_bytes() != old[CONFIG]
        if not begun:
            now = {n: d for n, d in files(folder).items() if n.partition("/")[0] != "tensorboard"}
            assert {n: d for n, d in now.items() if ".part" not in n} == {n: old[n] for n in old if n in now}
            assert {CHECKPOINT, MJCF} <= set(now)
        elif (folder / CHECKPOINT).exists():
            assert (folder / CHECKPOINT).read_bytes() != old[CHECKPOINT], "never one run's with another's"
        assert error is not None or (begun and load(folder / CHECKPOINT, "cpu")["iteration"] == 2)
