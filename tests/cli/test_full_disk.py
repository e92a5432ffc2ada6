"""Commands on a disk that fails at any call: each file is the old one or the new one, and a line names it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import workbench.diagnosis
import workbench.training.record
from tests.cli.here import run
from tests.disk import Disk, files, sweep
from tests.report import build
from workbench.effects import load_model
from workbench.models import write_model
from workbench.recordings import load_recording, save_recording
from workbench.rigs import VirtualLeg, chirp
from workbench.training.record import make_record

OLD = b"what was there before"


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("data") / "chirp.toml"
    save_recording(VirtualLeg(seed=4).run([chirp("knee", duration=1.0)])[0], path)
    return path


@pytest.fixture
def improved(monkeypatch: pytest.MonkeyPatch) -> None:
    """What takes long is not worked out: these tests are of what is then written."""
    result = build.improvement(seconds=1.0, rate=100.0), load_model("leg")
    monkeypatch.setattr(workbench.diagnosis, "improve", lambda *args, **more: result)


def attack(folder: Path, command: tuple, outputs: tuple[str, ...], there: bool) -> None:
    """`command` with `outputs`, which are there before or not."""
    (folder / "whole").mkdir()
    assert run(*command, cwd=folder / "whole").returncode == 0
    size = {name: (folder / "whole" / name).stat().st_size for name in outputs}
    for disk in sweep(folder):
        for name in outputs if there else ():
            (disk.folder / name).write_bytes(OLD)
        with disk:
            ended = run(*command, cwd=disk.folder)
        left = {n: d for n, d in files(disk.folder).items() if not n.startswith(".")}
        new = {n for n, data in left.items() if data != OLD}
        assert not there or set(left) == set(outputs)
        # stamps of time in them differ, and hardly their sizes
        assert all(abs(len(left[name]) - size[name]) <= 0.05 * size[name] for name in new)
        if ended.returncode == 0:
            assert new == set(outputs)
        else:
            assert re.fullmatch(r"error: \S+: .*No space left on device.*\n", ended.stderr), ended.stderr
            named = ended.stderr.split(": ")[1]
            assert named in outputs and named not in new
            assert not new or command[0] == "improve", "what fails leaves nothing; improve tells its result"


@pytest.mark.usefixtures("improved")
@pytest.mark.parametrize("there", [False, True])
def test_improve(tmp_path: Path, recording: Path, there: bool) -> None:
    page = ("steps.html",) if there else ()  # it takes most of the time
    outputs = "better.toml", "steps.json", *page
    command = ("improve", "leg", recording, "-q", "--force", "-o", outputs[0], "--json", outputs[1])
    attack(tmp_path, (*command, *(("--html", *page) if page else ())), outputs, there)


@pytest.mark.parametrize("there", [False, True])
def test_approve(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, recording: Path, there: bool) -> None:
    write_model(load_model("leg"), tmp_path / "mine.toml")
    record = make_record(load_model(str(tmp_path / "mine.toml")), [load_recording(recording)], samples=3)
    monkeypatch.setattr(workbench.training.record, "make_record", lambda *args, **more: record)
    outputs = "mine.record.json", "told.json"
    command = ("approve", tmp_path / "mine.toml", recording, "-q", "--force", "-o", outputs[0], "--json")
    attack(tmp_path, (*command, outputs[1]), outputs, there)


@pytest.mark.usefixtures("improved")
def test_what_improve_found_is_told_though_it_is_not_written(tmp_path: Path, recording: Path) -> None:
    outputs = "-o", "better.toml", "--json", "i.json"
    with Disk(1_000_000, tmp_path) as before:  # the outputs are tried; then there is nothing to read
        assert run("improve", "leg", "gone.toml", *outputs, cwd=tmp_path).returncode == 2
    with Disk(before.count + 1, tmp_path) as disk:
        ended = run("improve", "leg", recording, *outputs, cwd=tmp_path)
    assert disk.failed and ended.returncode == 2 and "error: better.toml: " in ended.stderr
    assert set(files(tmp_path)) == {"i.json"}
    assert "Coulomb friction" in ended.stdout and "Wrote" not in ended.stdout
