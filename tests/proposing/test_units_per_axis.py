"""A robot of turning and linear axes: each axis has its own unit, and what is stated of it is kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.proposing.make import KD, KP, imported, log, mixed, same, text
from workbench.core import InputError
from workbench.proposing import Answers, open_table, propose

LOG = log()
SLIDE = Answers(model_axes=("A1", "Z"), linear=(False, True))


def put(folder: Path, data: dict[str, np.ndarray]) -> Path:
    (folder / "run.csv").write_text(text(data))
    return folder / "run.csv"


def test_each_axis_keeps_the_unit_of_its_names(tmp_path: Path) -> None:
    proposal, recording = imported(put(tmp_path, mixed(LOG)))
    assert proposal.description["units"] == {
        "time": "ms",
        "position": ["deg", "mm"],
        "velocity": ["deg/s", "mm/s"],
        "torque": ["N*m", "N"],
    }
    same(recording, LOG)
    # N m/rad of the one, N/m of the other
    assert np.allclose(recording.controller.kp, KP, rtol=0.01)
    assert np.allclose(recording.controller.kd, KD, rtol=0.02)


def test_that_axes_turn_is_no_more_than_likely_unsaid(tmp_path: Path) -> None:
    bare = {
        name.replace("act", "pos"): v for name, v in mixed(LOG, units=False).items() if "drive" not in name
    }
    table = open_table(put(tmp_path, bare))

    def motion(answers: Answers) -> list[tuple[str, str]]:
        return [(a.value, a.word) for a in propose(table, answers).assumptions if a.what == "motion"]

    assert motion(Answers()) == [("a_1, z: turning", "likely")]
    assert not motion(SLIDE) and not motion(Answers(units={"position": "deg,mm"}))


def test_the_models_slide_is_a_length_where_no_name_says_so(tmp_path: Path) -> None:
    data = {k: v for k, v in mixed(LOG, units=False).items() if "drive" not in k}
    bare = {name.replace("act", "pos"): values for name, values in data.items()}
    units = propose(open_table(put(tmp_path, bare)), SLIDE).description["units"]
    assert units["position"] == ["deg", "mm"] and units["velocity"] == ["deg/s", "mm/s"]


def test_a_stated_unit_is_kept_and_said_to_be_doubtful(tmp_path: Path) -> None:
    proposal = propose(open_table(put(tmp_path, mixed(LOG, v="rad/s"))))
    assert proposal.description["units"]["velocity"] == ["rad/s", "mm/s"]
    said = next(note for note in proposal.notes if "A1 speed [rad/s]" in note)
    assert "data say velocity in deg/s" in said
    assert "--unit velocity=deg/s,mm/s" in said and "Z" not in said


def test_a_stated_unit_that_makes_turns_of_degrees_is_said(tmp_path: Path) -> None:
    proposal = propose(open_table(put(tmp_path, mixed(LOG, q="rad", v="rad/s"))))
    assert proposal.description["units"]["position"] == ["rad", "mm"]
    assert any("by size it is deg" in note and "position=deg,mm" in note for note in proposal.notes)


def test_velocities_overrule_the_clocks_name_and_say_so(tmp_path: Path) -> None:
    data = {name.replace("Stamp [ms]", "Stamp [s]"): values for name, values in mixed(LOG).items()}
    proposal = propose(open_table(put(tmp_path, data)))
    assert proposal.description["units"]["time"] == "ms"
    assert any("The name of 'Stamp [s]' says s" in note and "ms is used" in note for note in proposal.notes)


def test_a_column_in_another_unit_than_its_axis_is_scaled(tmp_path: Path) -> None:
    data = {}
    for name, values in mixed(LOG).items():
        data |= {"Z set [m]": values * 1e-3} if name == "Z set [mm]" else {name: values}
    _, recording = imported(put(tmp_path, data))
    assert np.abs(recording.signals["position_reference"] - LOG.ref).max() < 1e-9


def test_a_unit_that_is_none_of_the_models_joint_is_said(tmp_path: Path) -> None:
    turned = Answers(model_axes=("A1", "Z"), linear=(True, False))
    notes = propose(open_table(put(tmp_path, mixed(LOG))), turned).notes
    assert any("'A1' is an angle by its unit, but a slide in the model" in note for note in notes)
    assert not any("in the model" in note for note in propose(open_table(tmp_path / "run.csv"), SLIDE).notes)


def test_one_unit_for_axes_that_move_differently_is_refused(tmp_path: Path) -> None:
    table = open_table(put(tmp_path, mixed(LOG)))
    with pytest.raises(InputError, match="'z', which moves along a line") as caught:
        propose(table, Answers(units={"position": "rad"}))
    assert caught.value.remedy == "give one per axis: --unit position=rad,mm"


def test_the_user_says_one_unit_an_axis(tmp_path: Path) -> None:
    data = {k: v for k, v in mixed(LOG, units=False).items() if "drive" not in k}
    table = open_table(put(tmp_path, {k.replace("act", "pos"): v for k, v in data.items()}))
    said = {"position": "deg,mm", "velocity": "deg/s, mm/s"}
    proposal = propose(table, Answers(units=said))
    units = proposal.description["units"]
    assert units["position"] == ["deg", "mm"] and units["velocity"] == ["deg/s", "mm/s"]
    assert [a.word for a in proposal.assumptions if a.what == "unit of position"] == ["stated"]


@pytest.mark.parametrize("speed", [True, False])
def test_names_count_without_units(tmp_path: Path, speed: bool) -> None:
    data = {k: v for k, v in mixed(LOG, units=False).items() if speed or "speed" not in k}
    proposal = propose(open_table(put(tmp_path, data)), SLIDE)
    found, units = proposal.description["columns"], proposal.description["units"]
    assert found["position"] == ["A1 act", "Z act"] and found["position_reference"] == ["A1 set", "Z set"]
    assert found["torque_command"] == ["A1 drive out", "Z drive out"]
    assert found["torque_measured"] == ["A1 drive meas", "Z drive meas"]
    assert units["position"] == ["deg", "mm"] and units["torque"] == ["N*m", "N"]
    assert not any(note.startswith("Not used") for note in proposal.notes)
    taken = next(a for a in proposal.assumptions if a.what == "torque_measured")
    assert "read as torque" in taken.because and taken.word == "likely"


def test_the_loop_is_found_without_units(tmp_path: Path) -> None:
    _, recording = imported(put(tmp_path, mixed(LOG, units=False)), SLIDE)
    assert np.allclose(recording.controller.kp, KP, rtol=0.01)


def test_a_held_axis_keeps_its_reference(tmp_path: Path) -> None:
    data = mixed(LOG)
    data["Z set [mm]"] = np.full(len(LOG.t), 0.0)
    found = propose(open_table(put(tmp_path, data))).description["columns"]
    assert found["position_reference"] == ["A1 set [deg]", "Z set [mm]"]


def test_a_log_in_which_nothing_moves_yet_keeps_its_references(tmp_path: Path) -> None:
    data = {k: v[:20].copy() for k, v in mixed(LOG).items()}
    for i, name in enumerate(("A1 set [deg]", "Z set [mm]")):
        seen = name.replace("set", "act")
        data[name] = np.full(20, 10.0 + i)
        data[seen] = 10.0 + i + 0.01 * np.sin(np.arange(20))
    found = propose(open_table(put(tmp_path, data))).description["columns"]
    assert found["position_reference"] == ["A1 set [deg]", "Z set [mm]"]
    far = {k: v + 40.0 * ("set" in k) for k, v in data.items()}
    assert "position_reference" not in propose(open_table(put(tmp_path, far))).description["columns"]
    proposal, _ = imported(tmp_path / "run.csv")
    assert any("20 rows" in n and "too short" in n and "reference" not in n for n in proposal.notes)
    put(tmp_path, data)
    proposal, _ = imported(tmp_path / "run.csv")
    assert any("20 rows" in n and "too short" in n and "reference is logged too" in n for n in proposal.notes)
