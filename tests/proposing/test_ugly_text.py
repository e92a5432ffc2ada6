"""The same log, written in a dozen ugly ways, is the same recording."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.proposing.make import KD, KP, columns, imported, log, put, same, text
from workbench.core import InputError
from workbench.proposing import Answers, open_table, propose

LOG = log()
DEG = np.pi / 180


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
    assert any("restarts" in note for note in proposal.notes)


def test_text_that_breaks_off_within_a_letter_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.txt"
    path.write_bytes(text(columns(LOG)).encode("utf-16-le")[:-1])
    with pytest.raises(InputError, match="is no UTF-16-LE text from byte"):
        open_table(path)
