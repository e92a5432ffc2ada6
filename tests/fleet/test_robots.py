"""Recordings find their robot, its model, and their role."""

from pathlib import Path

import pytest

from workbench.core import InputError
from workbench.effects import load_model
from workbench.fleet import find_robots
from workbench.models import write_model


def log(folder: Path, name: str, rig: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{name}.toml"
    file.write_text(f'format = 1\ntable = "{name}.csv"\nrig = "{rig}"\n')
    return file


@pytest.fixture
def logs(tmp_path: Path) -> Path:
    for k in range(8):
        log(tmp_path / "logs" / "monday", f"run{k}", "leg-b")
    for k in range(2):
        log(tmp_path / "logs" / "tuesday", f"walk{k}", "leg-a")
    (tmp_path / "logs" / "model.toml").write_text("format = 1\n")  # no recording: it has no table
    return tmp_path / "logs"


def test_robots_by_name_whatever_the_order_and_place(logs: Path, tmp_path: Path) -> None:
    whole = find_robots([str(logs)], ["leg"])
    assert [r.name for r in whole] == ["leg-a", "leg-b"]
    assert not whole[0].held_out and len(whole[1].held_out) == 2 and len(whole[1].training) == 6
    listed = [str(f) for f in sorted(logs.rglob("*[0-9].toml"), reverse=True)]
    assert find_robots(listed, ["leg"]) == whole
    assert find_robots([str(logs / "**" / "*[0-9].toml"), listed[0]], ["leg"]) == whole
    moved = [str(log(tmp_path / "other", f.stem, "leg-b")) for f in whole[1].files]
    assert [f.stem for f in find_robots(moved, ["leg"])[0].held_out] == [f.stem for f in whole[1].held_out]


def test_who_judges_can_be_said(logs: Path) -> None:
    robots = find_robots([str(logs)], ["leg"], ["*1"])
    assert [[f.stem for f in r.held_out] for r in robots] == [["walk1"], ["run1"]]
    with pytest.raises(InputError, match="all recordings of 'leg-a' are held out"):
        find_robots([str(logs)], ["leg"], ["walk*"])


def test_each_robot_has_its_model(logs: Path, tmp_path: Path) -> None:
    folder = tmp_path / "models"
    folder.mkdir()
    write_model(load_model("leg"), folder / "leg-b.toml")
    own = find_robots([str(logs)], ["leg", f"leg-[bc]={folder}"])
    assert [r.model for r in own] == ["leg", str(folder / "leg-b.toml")]
    with pytest.raises(InputError, match="no model of robot 'leg-a'"):
        find_robots([str(logs)], [str(folder)])
    with pytest.raises(InputError, match="robot 'leg-b' has no model"):
        find_robots([str(logs)], ["leg-a=leg"])


def test_a_recording_of_no_robot_is_refused(logs: Path) -> None:
    log(logs, "stray", "")
    with pytest.raises(InputError, match=r"stray\.toml, key 'rig'"):
        find_robots([str(logs)], ["leg"])
    with pytest.raises(InputError, match="no file matches"):
        find_robots([str(logs / "*.nothing")], ["leg"])
