from __future__ import annotations

from pathlib import Path

import pytest

from tests.data_helpers import write_recording
from workbench.core import InputError
from workbench.ui import Shelf


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        write_recording(tmp_path / name)
    (tmp_path / "broken.toml").write_text("axes = [")
    (tmp_path / "unrelated.toml").write_text("a = 1")
    hidden = tmp_path / ".hidden"
    hidden.mkdir()
    write_recording(hidden)
    return tmp_path


def test_a_folder_offers_its_recordings_and_the_shipped_models(folder: Path) -> None:
    shelf = Shelf.of(None, [], folder)
    assert list(shelf.recordings) == ["one/made.toml", "two/made.toml"]
    assert {"leg", "leg_kin_only"} <= set(shelf.models)
    assert shelf.unreadable == {"broken.toml": "is not TOML"}
    assert shelf.recording("one/made.toml").axes == ("a", "b")


def test_what_was_named_stands_first_under_its_short_name(folder: Path) -> None:
    named = str(folder / "two" / "made.toml")
    shelf = Shelf.of("leg_kin_only", [named], folder / "one")
    assert next(iter(shelf.models)) == "leg_kin_only"
    assert list(shelf.recordings) == [named, "made.toml"]
    assert shelf.typed[shelf.recordings[named]] == named
    assert list(Shelf.of(None, [named], folder / ".hidden" / "none").recordings) == ["made"]


@pytest.mark.parametrize("label", ["/etc/passwd", "../one/made.toml", "one/../one/made.toml", ""])
def test_what_was_not_offered_cannot_be_opened(folder: Path, label: str) -> None:
    shelf = Shelf.of(None, [], folder)
    with pytest.raises(InputError, match="offered"):
        shelf.recording(label)
    with pytest.raises(InputError, match="offered"):
        shelf.model(label)


def test_named_files_must_exist_and_be_named_once(folder: Path) -> None:
    with pytest.raises(InputError, match="no such model file"):
        Shelf.of("nothing.toml", [], folder)
    path = str(folder / "one" / "made.toml")
    with pytest.raises(InputError, match="twice"):
        Shelf.of(None, [path, path], folder)


def test_a_description_that_changed_is_read_again(folder: Path) -> None:
    shelf = Shelf.of(None, [], folder)
    first = shelf.recording("one/made.toml")
    assert shelf.recording("one/made.toml") is first
    write_recording(folder / "one", name="other")
    assert shelf.recording("one/made.toml").name == "other"


_ARM = """<mujoco><worldbody><body><joint name="a"/><geom size="0.1"/></body></worldbody></mujoco>"""


def test_a_folder_s_robots_come_before_the_shipped_models(folder: Path) -> None:
    (folder / "arm.xml").write_text(_ARM)
    (folder / "one" / "hand.urdf").write_text("<robot name='hand'><joint name='a' type='revolute'/></robot>")
    (folder / "notes.xml").write_text("<notes><joint/></notes>")
    (folder / "looks.xml").write_text("<mujoco><asset/></mujoco>")
    (folder / "broken.urdf").write_bytes(b"\xff<robot")
    shelf = Shelf.of(None, [], folder)
    assert list(shelf.models)[:2] == ["arm", "hand"] and {"notes", "looks", "broken"}.isdisjoint(shelf.models)
    assert shelf.unreadable == {"broken.toml": "is not TOML"}
    assert shelf.model("arm").axes == ("a",)


def test_the_tree_of_a_described_model_is_not_offered_beside_it(folder: Path) -> None:
    (folder / "arm.xml").write_text(_ARM)
    (folder / "arm.toml").write_text('serial = "arm.xml"')
    shelf = Shelf.of(None, [], folder)
    assert shelf.models["arm"] == folder / "arm.toml" and folder / "arm.xml" not in shelf.models.values()


def test_a_broken_recording_is_not_offered_and_it_is_said_why(folder: Path) -> None:
    description = (folder / "one" / "made.toml").read_text()
    (folder / "no_table.toml").write_text(description.replace("table.csv", "gone.csv"))
    (folder / "no_axes.toml").write_text('format = 1\ntable = "one/table.csv"\n')
    shelf = Shelf.of(None, [], folder)
    assert list(shelf.recordings) == ["one/made.toml", "two/made.toml"]
    assert shelf.unreadable["no_table.toml"] == "its table gone.csv is not there"
    assert "no_axes.toml" in shelf.unreadable
