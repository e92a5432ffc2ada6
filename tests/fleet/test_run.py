"""A fleet's results: the same however they are worked out, none lost, none worked out twice."""

from __future__ import annotations

import os
import shutil
import signal
from collections.abc import Iterator
from dataclasses import replace
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest

import workbench.fleet.run
import workbench.fleet.task
from tests.models.make import leg_in_pieces
from workbench.core import InputError
from workbench.effects import load_model
from workbench.fleet import Robot, files_read, find_robots, fleet_dict, run_fleet, summarise
from workbench.fleet.store import fingerprint, keep, result_file, stored
from workbench.fleet.task import diagnose_robot
from workbench.recordings import save_recording
from workbench.report.json import dumps
from workbench.rigs import HiddenEffect, VirtualLeg, chirp


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two legs, one with a bias, and a third whose only table is broken."""
    folder = tmp_path_factory.mktemp("logs")
    bias = HiddenEffect("torque_bias", "knee", parameters={"torque": 0.5})
    for name, hidden in (("leg-1", []), ("leg-2", [bias])):
        (made,) = VirtualLeg(hidden, seed=3).run([chirp("knee", duration=2.0)])
        file = folder / f"{name}.toml"
        save_recording(made, file)
        file.write_text(file.read_text().replace('rig = "leg"', f'rig = "{name}"'))
    broken = (folder / "leg-1.toml").read_text().replace("leg-1", "leg-3")
    (folder / "broken.toml").write_text(broken)
    (folder / "leg-3.csv.gz").write_bytes(b"nothing")
    return folder


def test_one_that_fails_takes_nobody_along_and_a_rerun_goes_on(
    logs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robots = find_robots([str(logs)], ["leg"])
    told = run_fleet(robots, tmp_path, jobs=2)
    fleet = summarise(told)
    assert [r["verdict"] for r in told] == ["consistent", "missing_effect", None]
    assert "leg-3.csv.gz" in told[2]["failed"] and len(told[2]["failed"].splitlines()) == 1
    assert [(e.key.effect, e.robots) for e in fleet.effects] == [("torque_bias", ("leg-2",))]
    assert (tmp_path / "leg-2.toml").is_file() and told[1]["improved"] == "leg-2.toml"

    # stopped before the second robot was done: only that one is run, in this process, to the same bytes
    result_file(tmp_path, "leg-2").unlink()
    asked = []

    def counted(robot: Robot, *rest: Any) -> str | None:
        asked.append(robot.name)
        return diagnose_robot(robot, *rest)

    monkeypatch.setattr(workbench.fleet.task, "diagnose_robot", counted)
    again = run_fleet(robots, tmp_path, jobs=1)
    assert asked == ["leg-2", "leg-3"]
    assert dumps(fleet_dict(summarise(again))) == dumps(fleet_dict(fleet))

    with pytest.raises(InputError, match="other recordings, another model or seed"):
        run_fleet(robots, tmp_path, seed=1)


def test_a_result_depends_on_every_file_of_its_robot(logs: Path, tmp_path: Path) -> None:
    models = tmp_path / "models"
    shutil.copytree(next(f for f in load_model("leg").files if f.name == "leg.toml").parent, models)
    robot = Robot("leg-1", str(models / "leg.toml"), (logs / "leg-1.toml", logs / "broken.toml"))
    gone = tmp_path / "gone.toml"
    gone.write_text((logs / "leg-1.toml").read_text())
    read = files_read([robot, replace(robot, name="leg-2", held_out=(gone,))])
    names = ["leg.toml", "leg.xml", "leg.sdf", "leg-1.toml", "leg-1.csv.gz", "broken.toml", "leg-3.csv.gz"]
    assert [f.name for f in read] == [*names, "gone.toml"]  # whose table is not there
    before = fingerprint(robot, 0)
    assert before == fingerprint(robot, 0) != fingerprint(robot, 1)
    for file in [f for f in read if f.is_relative_to(models)]:
        kept = file.read_bytes()
        file.write_bytes(kept + b"\n")
        assert fingerprint(robot, 0) != before
        file.write_bytes(kept)
    assert fingerprint(robot, 0) == before


def test_a_result_depends_on_what_the_mjcf_draws_in(logs: Path, tmp_path: Path) -> None:
    robot = Robot("leg-1", str(leg_in_pieces(tmp_path)), (logs / "leg-1.toml",))
    before = fingerprint(robot, 0)
    for name in ("parts/option.xml", "meshes/thin/link.obj", "meshes/wide/link.obj"):
        file = tmp_path / "tree" / name
        assert file in files_read([robot])
        kept = file.read_text()
        file.write_text(f"{kept}\n")
        assert fingerprint(robot, 0) != before
        file.write_text(kept)
    assert fingerprint(robot, 0) == before


@pytest.mark.parametrize("library", ["workbench", "mujoco", "scipy"])
def test_a_result_depends_on_the_versions_it_was_made_with(
    library: str, robots: list[Robot], monkeypatch: pytest.MonkeyPatch
) -> None:
    before, known = fingerprint(robots[0], 0), metadata.version
    if library == "workbench":  # installed or not, it says its own
        monkeypatch.setattr("workbench.core.provenance.VERSION", "99.0")
    monkeypatch.setattr(metadata, "version", lambda name: "99.0" if name == library else known(name))
    assert fingerprint(robots[0], 0) != before


def test_a_result_that_cannot_be_read_says_why(tmp_path: Path) -> None:
    result_file(tmp_path, "a").mkdir()
    with pytest.raises(InputError, match=r"cannot be read .*directory"):
        stored(tmp_path, "a")


def killed_once() -> Any:
    """Work that kills its worker: that of 'b' the first time, that of 'd' always."""

    # a function inside a function is sent to workers as it is, and they need not find this file
    def work(robot: Robot, folder: Path, seed: int, inputs: str, cores: int) -> tuple[str, str | None]:
        flag = folder / f"{robot.name}.begun"
        if robot.name == "d" or (robot.name == "b" and not flag.exists()):
            flag.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        keep(folder, {"rig": robot.name, "inputs": inputs, "failed": None, "seed": seed})
        return robot.name, None

    return work


@pytest.fixture
def robots(logs: Path) -> list[Robot]:
    return [Robot(name, "leg", (logs / "leg-1.toml",)) for name in "abcd"]


def check_kept(told: list[dict[str, Any]], robots: list[Robot]) -> None:
    assert [r["rig"] for r in told] == [r.name for r in robots]
    assert [r["inputs"] for r in told] == [fingerprint(r, 5) for r in robots]
    assert [r["failed"] is None for r in told] == [r.name != "d" for r in robots]


def test_workers_that_are_killed_lose_nothing(
    robots: list[Robot], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workbench.fleet.run, "of_one_robot", killed_once())
    told = run_fleet(robots, tmp_path, seed=5, jobs=2)
    check_kept(told, robots)
    assert "its worker died" in told[3]["failed"]


@pytest.fixture
def cluster() -> Iterator[Any]:
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    ray = pytest.importorskip("ray", reason="Ray is not installed")
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, logging_level="error")
    yield ray
    ray.shutdown()


def test_a_cluster_loses_nothing_either(
    cluster: Any, robots: list[Robot], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workbench.fleet.run, "of_one_robot", killed_once())
    check_kept(run_fleet(robots[:3], tmp_path, seed=5, jobs=2, ray="auto"), robots[:3])
