"""The same log, written in a dozen ugly ways, is the same recording."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.proposing.make import KD, KP, columns, imported, log, same, text
from workbench.core import InputError
from workbench.proposing import Answers, open_table, propose
from workbench.proposing.names import role_of

LOG = log()
DEG = np.pi / 180


def put(folder: Path, content: str, name: str = "run.csv", encoding: str = "utf-8") -> Path:
    path = folder / name
    path.write_bytes(content.encode(encoding))
    return path


def test_plain_table_is_named_and_not_copied(tmp_path: Path) -> None:
    file = put(tmp_path, text(columns(LOG)))
    before = file.read_bytes()
    proposal, recording = imported(file)
    same(recording, LOG, tolerance=1e-9)
    assert proposal.data is None and file.read_bytes() == before
    assert sorted(p.name for p in (tmp_path / "made").iterdir()) == ["run.toml"]
    assert recording.axes == ("hip", "knee")
    assert recording.controller.kind == "pd"
    assert np.allclose(recording.controller.kp, KP, rtol=0.01)
    assert np.allclose(recording.controller.kd, KD, rtol=0.02)


def test_semicolons_and_decimal_commas(tmp_path: Path) -> None:
    same(imported(put(tmp_path, text(columns(LOG), ";", ",")))[1], LOG, tolerance=1e-9)


@pytest.mark.parametrize(
    "endings",
    [
        ("act_deg", "rate_dps", "set_deg", "cmd_Nm", "mot_Nm"),
        ("deg", "deg_s", "ref_deg", "cmd_Nm", "meas_Nm"),
    ],
)
def test_units_that_end_names_tell_what_columns_are(tmp_path: Path, endings: tuple[str, ...]) -> None:
    plain = columns(LOG, q=DEG, v=DEG)
    kinds = ("pos", "vel", "pos_ref", "cmd_torque", "torque")
    data = {"t": plain["t"]} | {
        f"{joint}_{ending}": plain[f"{kind}_{joint}"]
        for joint in ("hip", "knee")
        for kind, ending in zip(kinds, endings, strict=True)
    }
    assert f"hip_{endings[0]}" in data
    proposal, recording = imported(put(tmp_path, text(data)))
    same(recording, LOG, tolerance=1e-7)
    assert not any(note.startswith("Not used") for note in proposal.notes)
    assert recording.axes == ("hip", "knee") and recording.controller.kind == "pd"


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "latin-1"])
def test_encodings(tmp_path: Path, encoding: str) -> None:
    data = {
        k.replace("pos_", "Wärme pos_") if encoding == "latin-1" else k: v for k, v in columns(LOG).items()
    }
    same(imported(put(tmp_path, text(data), encoding=encoding))[1], LOG, tolerance=1e-9)


def test_milliseconds_since_1970(tmp_path: Path) -> None:
    data = columns(LOG, t=1e-3)
    data["t"] = data["t"] + 1.75e12
    proposal, recording = imported(put(tmp_path, text(data)))
    same(recording, LOG)
    assert proposal.description["units"]["time"] == "ms" and recording.period == pytest.approx(0.005)


@pytest.mark.parametrize(("size", "unit"), [(1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")])
def test_the_clock_unit_by_its_size(tmp_path: Path, size: float, unit: str) -> None:
    proposal, recording = imported(put(tmp_path, text(columns(LOG, t=size))))
    assert proposal.description["units"]["time"] == unit
    same(recording, LOG)


@pytest.mark.parametrize("named", [True, False])
def test_degrees(tmp_path: Path, named: bool) -> None:
    data = columns(LOG, q=DEG, v=DEG)
    if named:
        units = {"pos": " [deg]", "vel": " (°/s)", "cmd": " [Nm]", "tor": " [Nm]", "t": " [s]"}
        data = {k + units[k.split("_")[0][:3]]: v for k, v in data.items()}
    proposal, recording = imported(put(tmp_path, text(data)))
    assert proposal.description["units"]["position"] == "deg"
    assert proposal.description["units"]["velocity"] == "deg/s"
    same(recording, LOG)


def test_mixed_units_are_told_by_the_derivative(tmp_path: Path) -> None:
    proposal, recording = imported(put(tmp_path, text(columns(LOG, v=2 * np.pi / 60, t=1e-3))))
    units = proposal.description["units"]
    assert (units["time"], units["position"], units["velocity"]) == ("ms", "rad", "rpm")
    same(recording, LOG)


def test_a_row_of_units_below_the_names(tmp_path: Path) -> None:
    data = columns(LOG, tau=1e-3, q=DEG, v=DEG)
    names = {"t": "s", "pos": "deg", "vel": "deg/s", "cmd": "Nmm", "torque": "Nmm"}
    row = ",".join(names[k.split("_")[0]] for k in data)
    lines = text(data).split("\n")
    proposal, recording = imported(put(tmp_path, "\n".join(["# bench 3", lines[0], row, *lines[1:]])))
    assert proposal.description["units"]["torque"] == "N*mm"
    same(recording, LOG)


def test_newton_millimetres_without_a_name(tmp_path: Path) -> None:
    table = open_table(put(tmp_path, text(columns(LOG, tau=1e-3))))
    asked = propose(table).questions
    assert [q.key for q in asked] == ["unit.torque"] and "N*mm" in asked[0].choices
    same(imported(table.file, Answers(units={"torque": "Nmm"}))[1], LOG)


def test_blanks_and_no_header(tmp_path: Path) -> None:
    data = {"t": LOG.t, "a": LOG.q[:, 0], "b": LOG.q[:, 1], "c": LOG.v[:, 0], "d": LOG.v[:, 1]}
    proposal, recording = imported(put(tmp_path, text(data, "   ", header=False), "run.txt"))
    assert np.abs(recording.position - LOG.q).max() < 1e-9
    assert np.abs(recording.velocity - LOG.v).max() < 1e-9
    assert "velocity" not in recording.derived
    assert min(a.sure for a in proposal.assumptions if a.what in ("position", "velocity")) < 0.97


def test_rows_without_numbers_are_masked(tmp_path: Path) -> None:
    data = columns(LOG)
    data["pos_hip"] = data["pos_hip"].copy()
    data["pos_hip"][300:310] = np.nan
    _, recording = imported(put(tmp_path, text(data)))
    assert (~recording.valid).sum() == 10 and not recording.valid[300:310].any()
    assert np.abs(recording.velocity - LOG.v)[recording.valid].max() < 1e-6


def test_repeated_rows_are_left_out(tmp_path: Path) -> None:
    data = {k: np.insert(v, [100, 500], v[[100, 500]]) for k, v in columns(LOG).items()}
    proposal, recording = imported(put(tmp_path, text(data)))
    same(recording, LOG, tolerance=1e-9)
    assert any("repeat a time stamp" in note for note in proposal.notes)


def test_a_clock_coarser_than_the_rows(tmp_path: Path) -> None:
    data = columns(LOG)
    data["t"] = np.floor(data["t"] * 100) / 100
    proposal, recording = imported(put(tmp_path, text(data)))
    assert recording.period == pytest.approx(0.005, rel=1e-3)
    same(recording, LOG, tolerance=0.03)
    assert any("coarser" in note for note in proposal.notes)


def test_lost_rows_are_a_gap(tmp_path: Path) -> None:
    data = {k: np.delete(v, np.arange(400, 420)) for k, v in columns(LOG).items()}
    _, recording = imported(put(tmp_path, text(data)))
    assert len(recording) == len(LOG.t) and (~recording.valid).sum() == 20


def test_time_starting_anew_is_another_run(tmp_path: Path) -> None:
    data = {k: np.concatenate([v[:300], v]) for k, v in columns(LOG).items()}
    proposal, recording = imported(put(tmp_path, text(data)))
    same(recording, LOG, tolerance=1e-9)
    assert any("starts anew" in note for note in proposal.notes)


def test_velocity_missing_is_derived(tmp_path: Path) -> None:
    data = {k: v for k, v in columns(LOG).items() if not k.startswith("vel")}
    _, recording = imported(put(tmp_path, text(data)))
    assert recording.derived == ("velocity",)
    assert np.abs(recording.velocity - LOG.v)[5:-5].std() < 0.02 * LOG.v.std()


def test_velocity_counted_the_other_way(tmp_path: Path) -> None:
    data = columns(LOG)
    data["vel_knee"] = -data["vel_knee"]
    proposal, recording = imported(put(tmp_path, text(data)))
    same(recording, LOG, tolerance=1e-9)
    assert any("knee" in note and "sign" in note for note in proposal.notes)


def test_two_velocities_swapped_where_references_tell(tmp_path: Path) -> None:
    data = columns(LOG)
    data["vel_hip"], data["vel_knee"] = data["vel_knee"], data["vel_hip"]
    proposal, recording = imported(put(tmp_path, text(data)))
    same(recording, LOG, tolerance=1e-9)
    assert any("swapped" in note for note in proposal.notes)


def test_two_columns_swapped_where_nothing_tells_is_a_question(tmp_path: Path) -> None:
    data = {k: v for k, v in columns(LOG).items() if "ref" not in k and "cmd" not in k}
    data["vel_hip"], data["vel_knee"] = data["vel_knee"], data["vel_hip"]
    proposal = propose(open_table(put(tmp_path, text(data))))
    assert [q.key for q in proposal.questions] == ["column.velocity"] and not proposal.questions[0].best


def test_command_and_measured_told_by_who_leads(tmp_path: Path) -> None:
    lag, data = 4, {"time": LOG.t}
    for i, joint in enumerate(("hip", "knee")):
        data |= {
            f"{joint} angle": np.roll(LOG.q[:, i], -lag),
            f"{joint} pos": LOG.q[:, i],
            f"{joint} speed": LOG.v[:, i],
        }
    proposal = propose(open_table(put(tmp_path, text({k: v[:-lag] for k, v in data.items()}))))
    found = proposal.description["columns"]
    assert found["position"] == ["hip pos", "knee pos"]
    assert found["position_reference"] == ["hip angle", "knee angle"]


def test_qd_is_a_speed_or_a_reference_as_its_numbers_say(tmp_path: Path) -> None:
    both = {"t": LOG.t, **{f"q{i}": LOG.q[:, i] for i in (0, 1)}}
    speed = propose(open_table(put(tmp_path, text({**both, **{f"qd{i}": LOG.v[:, i] for i in (0, 1)}}))))
    wanted = propose(open_table(put(tmp_path, text({**both, **{f"qd{i}": LOG.ref[:, i] for i in (0, 1)}}))))
    assert speed.description["columns"]["velocity"] == ["qd0", "qd1"]
    assert wanted.description["columns"]["position_reference"] == ["qd0", "qd1"]
    assert "velocity" not in wanted.description["columns"]


def test_without_time_the_derivative_offers_the_rate(tmp_path: Path) -> None:
    data = {k: v for k, v in columns(LOG).items() if k != "t"}
    table = open_table(put(tmp_path, text(data)))
    asked = propose(table).questions
    assert [q.key for q in asked] == ["rate"] and float(asked[0].best) == pytest.approx(200, rel=0.03)
    same(imported(table.file, Answers(rate_hz=200.0))[1], LOG, tolerance=1e-9)


def test_a_torque_that_is_the_law_itself_is_the_command(tmp_path: Path) -> None:
    data = columns(LOG)
    for joint, i in (("hip", 0), ("knee", 1)):
        for name in [n for n in data if ("torque" in n and joint in n) or n == f"cmd_{joint}"]:
            del data[name]
        data[f"torque_{joint}"] = KP[i] * (LOG.ref[:, i] - LOG.q[:, i]) - KD[i] * LOG.v[:, i]
    proposal, recording = imported(put(tmp_path, text(data)))
    assert "torque_command" in recording.signals and "torque_measured" not in recording.signals
    assert recording.controller.kind == "pd" and not proposal.questions
    noisy = data | {n: v + 0.05 * np.ptp(v) * np.cos(9.0 * LOG.t) for n, v in data.items() if "torque" in n}
    assert "torque_measured" in imported(put(tmp_path, text(noisy)))[1].signals


def test_encoder_counts_are_asked_for(tmp_path: Path) -> None:
    data = columns(LOG)
    for joint, i in (("hip", 0), ("knee", 1)):
        data[f"pos_{joint}"] = np.round(LOG.q[:, i] / (2 * np.pi) * 65536)
        data[f"pos_ref_{joint}"] = LOG.ref[:, i] / (2 * np.pi) * 65536
    table = open_table(put(tmp_path, text(data)))
    assert [q.key for q in propose(table).questions] == ["counts"]
    proposal, recording = imported(table.file, Answers(counts=65536))
    same(recording, LOG)
    assert not any("wrong unit" in note for note in proposal.notes)


@pytest.mark.parametrize("name", ["rpm", "speed"])
def test_beside_encoder_counts_the_speed_tells_its_own_unit(tmp_path: Path, name: str) -> None:
    data = columns(LOG, v=2 * np.pi / 60)
    for joint, i in (("hip", 0), ("knee", 1)):
        data[f"pos_{joint}"] = np.round(LOG.q[:, i] / (2 * np.pi) * 65536)
        data[f"pos_ref_{joint}"] = LOG.ref[:, i] / (2 * np.pi) * 65536
        data[f"{name}_{joint}"] = data.pop(f"vel_{joint}")
    table = open_table(put(tmp_path, text(data)))
    proposal = propose(table, Answers(counts=65536))
    assert not proposal.questions and proposal.description["units"]["velocity"] == "rpm"
    assert not any("wrong unit" in note for note in proposal.notes)


def test_the_models_axes_by_name_and_by_order(tmp_path: Path) -> None:
    file = put(tmp_path, text(columns(LOG)))
    table = open_table(file)
    by_name = propose(table, Answers(model_axes=("knee_pitch", "hip_pitch")))
    assert by_name.description["columns"]["position"] == ["pos_knee", "pos_hip"] and not by_name.questions
    by_order = propose(table, Answers(model_axes=("first", "second")))
    assert [q.key for q in by_order.questions] == ["axes"] and "hip is first" in by_order.questions[0].text


def test_the_axis_without_a_position_is_named(tmp_path: Path) -> None:
    data = {k: v for k, v in columns(LOG).items() if k != "pos_knee"}
    with pytest.raises(InputError, match="has no position of knee_pitch") as caught:
        propose(open_table(put(tmp_path, text(data))), Answers(model_axes=("knee_pitch", "hip_pitch")))
    assert "--column 'position=NAME,pos_hip'" in str(caught.value.remedy)


def test_a_law_in_the_joints_is_found_behind_a_transmission(tmp_path: Path) -> None:
    belt = np.array([[1.0, 0.0], [1.0, 1.0]])
    data = {"t": LOG.t}
    command = LOG.cmd @ np.linalg.inv(belt)  # torques go the other way than motion
    for i, name in enumerate(("hip", "knee")):
        data |= {f"q_{name}": (LOG.q @ belt.T)[:, i], f"w_{name}": (LOG.v @ belt.T)[:, i]}
        data |= {f"qref_{name}": LOG.ref[:, i], f"cmd_{name}": command[:, i]}
    file = put(tmp_path, text(data))
    asked = propose(open_table(file), Answers(transmission=belt)).questions
    assert [q.key for q in asked] == ["coordinates"]
    _, recording = imported(file, Answers(transmission=belt, coordinates="actuator"))
    assert recording.controller.coordinates == "joint"
    assert np.allclose(recording.controller.kp, KP, rtol=0.01)


def test_text_that_breaks_off_within_a_letter_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.txt"
    path.write_bytes(text(columns(LOG)).encode("utf-16-le")[:-1])
    with pytest.raises(InputError, match="is no UTF-16-LE text from byte"):
        open_table(path)


@pytest.mark.parametrize("joints", [("hip", "foot"), ("rod", "link")])
def test_joints_that_are_called_like_units_of_length_are_joints(
    tmp_path: Path, joints: tuple[str, str]
) -> None:
    data = {
        name.replace("hip", "#").replace("knee", joints[1]).replace("#", joints[0]): values
        for name, values in columns(LOG).items()
    }
    recording = imported(put(tmp_path, text(data)))[1]
    same(recording, LOG, tolerance=1e-9)
    assert recording.axes == joints


def test_a_column_that_numbers_rows_has_no_unit_though_n_is_one_of_force() -> None:
    assert (role_of("n").kind, role_of("n").unit) == ("index", "")
