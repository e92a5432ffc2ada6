"""A model of a stranger: it loads no code, reads nothing outside of its folder, and does not grow."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

from workbench.core import InputError
from workbench.core.paths import models_folder
from workbench.importing import contents_of
from workbench.models import load_mjcf, read_model
from workbench.models.mjcf import check_mjcf
from workbench.s3n.sdf import read_sdf

LEG = (models_folder() / "serial" / "leg.xml").read_text()
SDF = (models_folder() / "closed_chain" / "leg.sdf").read_text()
LAUGHS = '<!DOCTYPE x [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]>'
OUTSIDE = '<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]>'


def refused(path: Path, says: str) -> None:
    with pytest.raises(InputError, match=says) as caught:
        read_model(path)
    assert str(caught.value).isprintable() and "root:" not in str(caught.value) and caught.value.remedy


def with_(text: str, content: str) -> str:
    """The MJCF with something in front of its bodies."""
    assert "<worldbody>" in text
    return text.replace("<worldbody>", f"{content}<worldbody>", 1)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ('<include file="/etc/passwd"/>', "is not a path inside"),
        ('<include file="../out.xml"/>', "is outside its folder"),
        ('<include file="leg.xml"/>', "included by itself"),
        ('<include file="link.xml"/>', "is outside its folder"),
        ('<asset><model name="m" file="leg.xml"/></asset>', "included by itself"),
        ('<asset><model name="m" file="../out.xml"/></asset>', "is outside its folder"),
        ('<asset><mesh name="m" file="../../out.stl"/></asset>', "is outside its folder"),
        ('<asset><mesh name="m" file="/dev/zero"/></asset>', "is not a path inside"),
        ('<compiler meshdir="../../"/><asset><mesh name="m" file="a.stl"/></asset>', "is outside its folder"),
        ('<extension><plugin plugin="mujoco.pid"/></extension>', "plugin"),
        ('<option gravity="0 0 -1e300"/>', r"gravity is -1e\+300 m/s\^2"),
        ("<a>" * 500 + "</a>" * 500, "nests more than"),
    ],
)
def test_an_mjcf_describes_a_body_and_no_more(content: str, says: str, tmp_path: Path) -> None:
    folder = tmp_path / "own"
    folder.mkdir()
    (tmp_path / "out.xml").write_text("<mujoco/>")
    (folder / "link.xml").symlink_to(tmp_path / "out.xml")
    (folder / "leg.xml").write_text(with_(LEG, content))
    refused(folder / "leg.xml", says)


def test_files_beside_and_below_may_be_included(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "option.xml").write_text('<mujoco><option timestep="0.002"/></mujoco>')
    (tmp_path / "leg.xml").write_text(with_(LEG, '<include file="parts/option.xml"/>'))
    assert load_mjcf(tmp_path / "leg.xml").option.timestep == 0.002


def test_meshes_may_lie_in_a_folder_beside_that_of_the_file(tmp_path: Path) -> None:
    for name in ("meshes", "xml"):
        (tmp_path / name).mkdir()
    (tmp_path / "meshes" / "corner.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    )
    named = '<compiler meshdir="../meshes/"/><asset><mesh name="corner" file="corner.obj"/></asset>'
    (tmp_path / "xml" / "leg.xml").write_text(with_(LEG, named))
    assert len(load_mjcf(tmp_path / "xml" / "leg.xml").meshes) == 1


def test_a_model_that_is_attached_may_no_more_than_the_first(tmp_path: Path) -> None:
    (tmp_path / "leg.xml").write_text(with_(LEG, '<asset><model name="c" file="child.xml"/></asset>'))
    (tmp_path / "child.xml").write_text("<mujoco/>")
    assert tmp_path / "child.xml" in check_mjcf(tmp_path / "leg.xml")
    (tmp_path / "child.xml").write_text(
        '<mujoco><extension><plugin plugin="mujoco.pid"/></extension></mujoco>'
    )
    refused(tmp_path / "leg.xml", "plugin")


@pytest.mark.parametrize("entities", [LAUGHS, OUTSIDE])
def test_entities(entities: str, tmp_path: Path) -> None:
    (tmp_path / "leg.xml").write_text(entities + LEG)
    refused(tmp_path / "leg.xml", "declares a document type")
    file = tmp_path / "leg.sdf"
    file.write_text(SDF.replace("<sdf", f"{entities}<sdf", 1))
    for read in (contents_of, read_sdf):
        with pytest.raises(InputError, match="declares a document type"):
            read(file)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
def test_entities_do_not_hide_in_wide_characters(encoding: str, tmp_path: Path) -> None:
    wide = f'<?xml version="1.0" encoding="{encoding}"?>{LAUGHS}'
    (tmp_path / "leg.xml").write_bytes((wide + LEG[LEG.index("<mujoco") :]).encode(encoding))
    refused(tmp_path / "leg.xml", "not UTF-8")
    (tmp_path / "leg.sdf").write_bytes((wide + SDF[SDF.index("<sdf") :]).encode(encoding))
    for read in (contents_of, read_sdf):
        with pytest.raises(InputError, match="not UTF-8"):
            read(tmp_path / "leg.sdf")


@pytest.mark.parametrize("what", ["file:///etc/passwd", "model://other", "../other.sdf"])
def test_an_sdf_draws_nothing_in(what: str, tmp_path: Path) -> None:
    file = tmp_path / "leg.sdf"
    file.write_text(SDF.replace("<link", f"<include><uri>{what}</uri></include><link", 1))
    with pytest.raises(InputError, match="includes other files"):
        contents_of(file)


@pytest.mark.parametrize("name", ["leg.dmd.yaml", "leg.sdf"])
def test_a_chain_is_an_sdf_or_a_urdf(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text("directives:\n- add_model: {name: a, file: file:///etc/passwd}\n")
    with pytest.raises(InputError, match="SDF or URDF"):
        contents_of(tmp_path / name)


@pytest.mark.parametrize("serial", ["/etc/passwd", "../../etc/passwd", "/dev/zero", "leg.mjb", "."])
def test_a_serial_tree_is_an_mjcf(serial: str, tmp_path: Path) -> None:
    mujoco.mj_saveModel(mujoco.MjModel.from_xml_string("<mujoco/>"), str(tmp_path / "leg.mjb"))
    (tmp_path / "a.toml").write_text(f'format = 1\nname = "a"\nserial = "{serial}"\n')
    refused(tmp_path / "a.toml", "does not exist|cannot read")


def test_mujoco_leaves_no_file_and_says_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    m = load_mjcf(models_folder() / "serial" / "leg.xml").compile()
    data = mujoco.MjData(m)
    data.qvel[:] = float("nan")
    mujoco.mj_step(m, data)
    assert data.warning.number.sum() > 0 and list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("what", ["armature", "damping", "frictionloss"])
def test_less_than_nothing_of_a_joint_is_refused(what: str, tmp_path: Path) -> None:
    file = tmp_path / "arm.xml"
    file.write_text(
        f'<mujoco><worldbody><body><joint name="a" {what}="-0.1"/><geom size="0.1"/></body>'
        "</worldbody></mujoco>"
    )
    with pytest.raises(InputError, match=f"joint 'a' has {what} -0.1"):
        read_model(file)
