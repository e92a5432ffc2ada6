"""Dry friction that a file states is rigid here, and a note says what MuJoCo makes of it there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tests.cli.here import run
from tests.dry_arm import RIGID, dry_arm, made
from workbench.comparison import compare
from workbench.core import Comparison
from workbench.diagnosis import diagnose
from workbench.effects import load_model

_LINK = """<link name="{}"><inertial><origin xyz="{} 0 0"/><mass value="{}"/>
<inertia ixx="0.004" iyy="{}" izz="{}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
_URDF = f"""<robot name="dry"><link name="base"/>{_LINK.format("arm", 0.1, 2, 0.07, 0.07)}
{_LINK.format("rod", 0.05, 1.3, 0.005, 0.005)}<joint name="lift" type="continuous"><parent link="base"/>
<child link="arm"/><axis xyz="0 -1 0"/><dynamics damping="0.3" friction="0.6"/></joint>
<joint name="reach" type="prismatic"><parent link="arm"/><child link="rod"/><origin xyz="0.2 0 0"/>
<axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/><dynamics damping="2" friction="4"/>
</joint></robot>"""
_NAME = "friction constraint is soft"


def soft_notes(comparison: Comparison) -> list[str]:
    return [note for note in comparison.notes if _NAME in note]


@pytest.mark.parametrize("where", ["joint", "fixed"])
def test_a_right_file_explains_the_log_and_hears_it_is_soft(tmp_path: Path, where: str) -> None:
    log = made(dry_arm(tmp_path, where, RIGID, name="machine"))
    found = compare(load_model(dry_arm(tmp_path, where)), [log])
    assert found.consistent and found.inverse_dynamics is not None
    assert found.inverse_dynamics.relative_error < 0.05
    (note,) = soft_notes(found)
    assert 'solreffriction="0.004 1" solimpfriction="0.99 0.99"' in note
    as_told = load_model(dry_arm(tmp_path, where, 'solreffriction="0.004 1" solimpfriction="0.99 0.99"'))
    told = compare(as_told, [log])
    assert told.consistent and not soft_notes(told)
    found = diagnose(load_model(dry_arm(tmp_path, where)), [log])
    assert found.verdict == "consistent" and any(_NAME in note for note in found.notes)
    bare = compare(load_model(dry_arm(tmp_path, "none")), [log])
    assert not bare.consistent and not soft_notes(bare)


def test_a_urdf_which_can_state_no_softness_is_not_told_to(tmp_path: Path) -> None:
    log = made(dry_arm(tmp_path, "joint", RIGID, name="machine"))
    (tmp_path / "dry.urdf").write_text(_URDF)
    (note,) = soft_notes(compare(load_model(tmp_path / "dry.urdf"), [log]))
    assert note.startswith("the URDF's dry friction") and "give it" not in note
    assert note.endswith("train in what workbench normalize writes")


def test_logs_that_have_the_softness_are_explained_by_it(tmp_path: Path) -> None:
    """Whoever holds MuJoCo's own runs against the file has it on both sides."""
    file = dry_arm(tmp_path)
    log = made(file)
    model = load_model(file)
    found = compare(model, [log])
    assert found.consistent and not soft_notes(found)
    assert any("soft_friction = true" in note or "stepped = true" in note for note in found.notes)
    stated = compare(replace(model, friction_as_in_mjcf=True), [log])
    assert stated.consistent and not soft_notes(stated)


def test_add_writes_that_friction_is_as_soft_as_in_the_file(tmp_path: Path) -> None:
    file = dry_arm(tmp_path)
    done = run("add", file, "friction_as_in_mjcf", "-o", tmp_path / "soft.toml")
    assert done.returncode == 0 and load_model(tmp_path / "soft.toml").friction_as_in_mjcf
    bare = run("add", dry_arm(tmp_path, "none"), "friction_as_in_mjcf", "-o", tmp_path / "bare.toml")
    assert bare.returncode == 2 and "no dry friction of its own" in bare.stderr
    assert not (tmp_path / "bare.toml").exists()
