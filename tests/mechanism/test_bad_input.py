"""Whatever is wrong with a user's file or description is said in one line, with a place and a remedy."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.core import InputError, Mechanism, SimulationError
from workbench.core.paths import closed_chain_file
from workbench.mechanism import ClosedChain
from workbench.mechanism.parse import parse

from .chains import chain, mechanism

TEXT = closed_chain_file("leg").read_text()
CUT = '<joint name="cut" type="revolute"><parent>coupler</parent><child>shank</child>'
CUT += "<axis><xyz>0 -1 0</xyz></axis></joint>"
BOX = "<link name='box'/><joint name='lid' type='revolute'><parent>shank</parent><child>box</child>"
BOX += "<axis><xyz>0 1 0</xyz></axis></joint>"
CHILD = "<child>coupler</child>\n      <axis>"
MIMIC = CHILD + "<mimic joint='knee'><multiplier>1</multiplier><offset>0.3</offset>"
MIMIC += "<reference>0</reference></mimic>"

IN_THE_FILE = {
    "no XML": ("<?xml", "?", "not an XML file: .*; give an SDF or URDF file"),
    "a mass in letters": ("<mass>1.8", "<mass>heavy", r":13: error.*<mass>; correct what it names"),
    "no mass": ("<mass>1.8", "<mass>0", r"row 10: an inertia that no link can have: .*mass > 0.*; give a"),
    "an inertia below zero": ("<iyy>0.0003<", "<iyy>-1<", r"row 33: an inertia that no link can have"),
    "moments that no body has": ("<iyy>0.0003<", "<iyy>1<", "do not satisfy the triangle inequality"),
    "no inertia": ("</model>", f"{BOX}</model>", r"column 'inertial': link 'box' has no <inertial>"),
    "a ball joint": ('knee" type="revolute', 'knee" type="ball', "joint 'knee' is of type ball_rpy; use rev"),
    "an endless version": ('version="1.9"', f'version="{2**63}"', "read it: a whole number is too"),
    "a pose beyond numbers": ("0 0 -0.175 0 0 0</pose></frame>", "0 0 1e308 0 0 0</pose></frame>", "inf m"),
    "a link out of this world": ("<pose>0 0 0.03 0", "<pose>0 1e308 0.03 0", "matrix is not finite; give"),
    "a joint follows another": (CHILD, MIMIC, "leave 1 degrees of freedom for 2 drives"),
    "a joint follows no one": (CHILD, MIMIC.replace("'knee'", "'nobody'"), "nobody. specified by an axis m"),
    "a joint of the loop": ("</model>", f"{CUT}</model>", "its joints form a loop; leave out one"),
    "a coupler of a metre": ("0 0 -0.175 0 0 0</pose></frame>", "0 0 -1 0 0 0</pose></frame>", "0.825 m"),
}  # fmt: skip


@pytest.mark.parametrize("what", IN_THE_FILE)
def test_a_wrong_file(what: str, tmp_path: Path) -> None:
    old, new, message = IN_THE_FILE[what]
    assert old in TEXT
    file = tmp_path / "own.sdf"
    file.write_text(TEXT.replace(old, new))
    with pytest.raises(InputError, match=message) as error:
        ClosedChain(file)
    assert str(file) in str(error.value)
    assert "\n" not in str(error.value)


def test_what_would_end_the_process_is_an_error(tmp_path: Path) -> None:
    file = tmp_path / "own.urdf"
    file.write_text(
        '<robot name="r"><link name="world"/><link name="arm"/><joint name="j" type="revolute">'
        '<parent link="world"/><child link="arm"/><axis xyz="0 1 0"/>'
        '<limit lower="2" upper="1" effort="9" velocity="9"/></joint></robot>'
    )
    with pytest.raises(InputError, match=r"cannot read it: condition .*pos_upper_limits.* failed") as error:
        parse(file)
    assert str(error.value).isprintable()


LEG = Mechanism(closed_chain_file("leg"))
IN_THE_DESCRIPTION = {
    "no file": (replace(LEG, file=Path("own.sdf")), "own.sdf: the file does not exist; give the path"),
    "no drives": (replace(LEG, drives=(), joints=()), "drives': 0 drives, and drives are none; name one"),
    "a drive twice": (replace(LEG, drives=("hip", "hip")), "drives': 2 drives, and drives are hip, hip"),
    "a joint short": (replace(LEG, joints=("hip",)), "joints': 2 drives, and joints are hip; name"),
    "no such drive": (replace(LEG, drives=("hip", "motor")), "no joint 'motor'.*; coordinates are hip"),
    "no such joint": (replace(LEG, joints=("hip", "ankle")), "joints': the file has no joint 'ankle'"),
    "no such frame": (replace(LEG, loops=(("foot", "end"),)), "loops': the file has no frame 'end'; frames"),
    "no such foot": (replace(LEG, foot="toe"), "foot': the file has no frame 'toe'; frames"),
    "no such start": (replace(LEG, start=(("ankle", 1.0),)), "start': the file has no joint 'ankle'"),
    "a start that is none": (replace(LEG, start=(("knee", np.nan),)), "the start of 'knee' is nan; give"),
    "no loop": (replace(LEG, loops=()), "4 degrees of freedom.* knee, coupler_pin can still move"),
    "a drive less": (replace(LEG, drives=("hip",), joints=("hip",)), "2 degrees of freedom for 1 drives"),
    "a drive more": (
        replace(LEG, drives=("hip", "knee", "crank_pin"), joints=("hip", "knee", "crank_pin")),
        "2 degrees of freedom for 3 drives; leave out a loop or a drive",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", IN_THE_DESCRIPTION)
def test_a_wrong_description(what: str) -> None:
    description, message = IN_THE_DESCRIPTION[what]
    with pytest.raises(InputError, match=message) as error:
        ClosedChain(description)
    assert str(description.file) in str(error.value)
    assert "; " in str(error.value)


def test_a_payload_is_a_mass() -> None:
    with pytest.raises(InputError, match="a payload of -1 kg; give a mass"):
        ClosedChain(LEG, payload=-1)


def test_no_foot_is_an_error_only_where_it_is_asked_for() -> None:
    footless = ClosedChain(replace(LEG, foot=None))
    with pytest.raises(InputError, match=r"closed_chain.foot': the mechanism has no foot; name the frame"):
        footless.foot_position(np.array([0.1, 0.8]))


def test_links_without_mass_make_the_mass_matrix_singular(tmp_path: Path) -> None:
    """URDF takes a link without <inertial> for massless, as frames are often written there."""
    joint = '<joint name="{}" type="continuous"><parent link="{}"/><child link="{}"/></joint>'
    file = tmp_path / "own.urdf"
    file.write_text(
        '<robot name="own"><link name="world"/><link name="a"/><link name="b"/>'
        + joint.format("p", "world", "a") + joint.format("q", "a", "b") + "</robot>"
    )  # fmt: skip
    with pytest.raises(InputError, match="the mass matrix is singular; links without mass: a, b"):
        ClosedChain(Mechanism(file, ("p", "q"), ("p", "q"), (), None))


def test_numbers_that_are_none_do_not_reach_drake() -> None:
    """Drake would end the process."""
    for value in (np.nan, np.inf):
        with pytest.raises(SimulationError, match=f"not finite: hip = 0.1, crank_pin = {value}"):
            chain("leg").tree_position(np.array([0.1, value]))
    with pytest.raises(SimulationError, match="not finite"):
        chain("leg").reduced_dynamics(np.array([0.1, 1.0]), np.array([0.1, np.nan]))


def test_drives_out_of_the_workspace_are_named() -> None:
    with pytest.raises(SimulationError, match=r"cannot be closed at hip = 0, crank_pin = 3"):
        chain("four_bar").tree_position(np.array([0.0, 3.0]))
    with pytest.raises(SimulationError, match=r"cannot be closed at pitch = -1.1, roll = 0"):
        chain("ankle").drive_position(np.array([-1.1, 0.0]))


def test_a_start_at_a_dead_point_of_the_serial_joints_says_so() -> None:
    """An upright rod does not begin to lean when the foot rolls, so its lean cannot stand for the roll."""
    leaning = ClosedChain(replace(mechanism("ankle"), joints=("pitch", "left_rod_top_qx"), limits=()))
    message = "the start posture is a dead point, pitch = 0, left_rod_top_qx = 0: give another"
    with pytest.raises(SimulationError, match=message):
        leaning.drive_position(np.array([0.1, 0.01]))
