"""Logs of other people: candump, BLF and ASC with a DBC become one recording; gaps are masked."""

from __future__ import annotations

from pathlib import Path

import can
import numpy as np
import pytest

from workbench.can import Damiao, Feedback, Ranges, dbc
from workbench.core import InputError
from workbench.recordings import load_recording

RANGES = Ranges(12.5, 30.0, 10.0, 500.0, 5.0, "label")
DRIVES = {"hip": Damiao(1, 0x11, RANGES), "knee": Damiao(2, 0x12, RANGES)}
TOML = """
format = 1
table = "{table}"
axes = ["hip", "knee"]
[columns]
time = "t"
position = ["position_hip", "feedback_12.position_knee"]
velocity = ["velocity_hip", "velocity_knee"]
torque_measured = ["torque_hip", "torque_knee"]
{more}
"""


def motion(t: float) -> tuple[float, float]:
    return float(np.sin(6 * t)), float(6 * np.cos(6 * t))


def logged(folder: Path, ending: str, lost: range = range(0), more: str = "") -> Path:
    table = folder / f"run{ending}"
    with can.Logger(table) as log:
        for k in range(400):
            for j, drive in enumerate(DRIVES.values()):
                if j and k in lost:
                    continue
                t = k * 0.003 + j * 0.0004
                frame = drive.answer(Feedback(*motion(t), 0.1, 30.0, True))
                log(can.Message(1e9 + t, frame.id, False, data=frame.data, channel=0, is_rx=True))
                log(can.Message(1e9 + t + 1e-4, 0x300, False, data=b"\1", channel=0, is_rx=True))
    (folder / "run.dbc").write_text(dbc(DRIVES))
    path = folder / "run.toml"
    path.write_text(TOML.format(table=table.name, more=more))
    return path


@pytest.mark.parametrize("ending", [".log", ".blf", ".asc", ".mf4"])
def test_logs_of_every_form_are_the_same_recording(tmp_path: Path, ending: str) -> None:
    read = load_recording(logged(tmp_path, ending))
    assert len(read) == pytest.approx(400, abs=1) and read.period == pytest.approx(0.003, rel=1e-3)
    wanted = np.array([motion(t)[0] for t in read.time])
    for axis in (0, 1):  # both at one time, though the knee answers 0.4 ms later
        assert np.abs(read.position[2:-2, axis] - wanted[2:-2]).max() < 1.5e-3


def test_what_is_missing_is_masked(tmp_path: Path) -> None:
    read = load_recording(logged(tmp_path, ".log", range(100, 120), 'valid = "valid"'))
    assert 18 <= (~read.valid).sum() <= 22 and not read.valid[105:115].any()


def test_what_is_missing_is_not_held_in_silence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="position_knee"):
        load_recording(logged(tmp_path, ".log", range(100, 120)))


def test_what_cannot_be_read_is_named(tmp_path: Path) -> None:
    path = logged(tmp_path, ".log")
    path.write_text(path.read_text().replace('"velocity_hip"', '"velocity_hop"'))
    with pytest.raises(InputError, match="velocity_hop"):
        load_recording(path)
    (tmp_path / "run.dbc").unlink()
    with pytest.raises(InputError, match="needs a DBC"):
        load_recording(path)


def test_what_a_reader_would_leave_out_is_refused(tmp_path: Path) -> None:
    path = logged(tmp_path, ".blf")
    raw = bytearray((tmp_path / "run.blf").read_bytes())
    place = raw.index(b"LOBJ") + 16  # the first container's method of compression
    raw[place : place + 2] = b"\x02\x02"
    (tmp_path / "run.blf").write_bytes(raw)
    with pytest.raises(InputError, match=r"not a readable log: Unknown compression method \(514\)"):
        load_recording(path)
