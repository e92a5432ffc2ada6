"""Tables and logs that no instrument has written: refused in one line, without a crash of the reader."""

from __future__ import annotations

import re
import struct
import zlib
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from asammdf import MDF
from asammdf.blocks.v4_blocks import ChannelConversion
from asammdf.blocks.v4_constants import CONVERSION_TYPE_ALG
from scipy.io import savemat

from tests.data_helpers import description, two_axes, write_recording
from tests.recordings.refuse import changed, refused, refused_table
from tests.recordings.test_can_logs import logged
from workbench.recordings.tables import apart


def test_numbers_that_nothing_that_moves_can_have(tmp_path: Path) -> None:
    error = refused_table(tmp_path, changed("q_a", 9, 1e200))
    assert error.column == "q_a" and error.row == 9 and "1e+200" in error.problem


def test_a_gap_that_would_fill_the_memory(tmp_path: Path) -> None:
    table = {**two_axes(), "ok": np.ones(400)}
    table["t"] = np.where(np.arange(400) > 200, table["t"] + 1e9, table["t"])
    columns = {**description()["columns"], "valid": "ok"}
    error = refused(write_recording(tmp_path, table, columns=columns))
    assert error.column == "t" and error.row == 202 and "jumps by" in error.problem


def test_times_that_differ_by_less_than_their_rounding(tmp_path: Path) -> None:
    t = two_axes()["t"]
    error = refused_table(tmp_path, changed("t", 2, t[0] + 5e-324))
    assert error.row == 2 and "repeats" in error.problem


def matlab(folder: Path, at: int, old: bytes, new: bytes) -> Path:
    """A recording whose MATLAB table has some bytes exchanged, counted from the file's start."""
    path = write_recording(folder, table="table.mat")
    savemat(folder / "table.mat", two_axes())
    raw = bytearray((folder / "table.mat").read_bytes())
    assert raw[at : at + len(old)] == old
    raw[at : at + len(new)] = new
    (folder / "table.mat").write_bytes(raw)
    return path


@pytest.mark.parametrize(
    ("at", "old", "new"),
    [
        (176, struct.pack("<I", 9), struct.pack("<I", 105)),  # a type of numbers that there is not
        (180, struct.pack("<I", 3200), struct.pack("<I", 3208)),  # more bytes than there are
        (164, struct.pack("<i", 400), struct.pack("<i", 500)),  # more numbers than there are
        (132, struct.pack("<I", 3248), struct.pack("<I", 2**31)),
    ],
)
def test_matlab_files_whose_tags_contradict_each_other(
    at: int, old: bytes, new: bytes, tmp_path: Path
) -> None:
    assert "not a readable MATLAB file" in refused(matlab(tmp_path, at, old, new)).problem


def test_matlab_objects_are_no_columns(tmp_path: Path) -> None:
    path = write_recording(tmp_path, table="table.mat")
    cells = np.array([*two_axes()["q_a"][:-1], "x"], dtype=object)
    savemat(tmp_path / "table.mat", {**two_axes(), "q_a": cells})
    assert refused(path).column == "q_a"


def test_parquet_objects_are_no_columns(tmp_path: Path) -> None:
    path = write_recording(tmp_path, table="table.parquet")
    table = {**two_axes(), "q_a": [{"a": 1.0}] * 400}
    pq.write_table(pa.table(table), tmp_path / "table.parquet")
    assert refused(path).column == "q_a"


def test_a_parquet_header_with_names_that_are_no_text(tmp_path: Path) -> None:
    path = write_recording(tmp_path, table="table.parquet")
    pq.write_table(pa.table({n: pa.array(v) for n, v in two_axes().items()}), tmp_path / "table.parquet")
    raw = (tmp_path / "table.parquet").read_bytes()
    (tmp_path / "table.parquet").write_bytes(raw.replace(b"tau_b", b"\xf3au_b"))
    refused(path)


@pytest.mark.parametrize("ending", [".blf", ".mf4"])
def test_damaged_logs(ending: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = logged(tmp_path, ending)
    raw = bytearray((tmp_path / f"run{ending}").read_bytes())
    for at in (len(raw) // 3, len(raw) // 2):
        raw[at : at + 64] = bytes(range(64))
    (tmp_path / f"run{ending}").write_bytes(raw)
    assert "not a readable log" in refused(path).problem
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("packed", [True, False])
def test_a_log_that_its_reader_would_never_leave(packed: bool, tmp_path: Path) -> None:
    path = logged(tmp_path, ".blf")
    raw = bytearray((tmp_path / "run.blf").read_bytes())
    at = raw.index(b"LOBJ")  # the first container: 16 bytes of header, 16 of its own, then what it holds
    size = int.from_bytes(raw[at + 8 : at + 12], "little")
    held = bytearray(zlib.decompress(raw[at + 32 : at + size]))
    second = held.index(b"LOBJ", 200)
    held[second + 8 : second + 12] = bytes(4)  # of no size: the next begins where it begins
    body = zlib.compress(held) if packed else bytes(held)
    length = 32 + len(body)
    container = raw[at : at + 8] + length.to_bytes(4, "little") + raw[at + 12 : at + 16]
    container += (2 if packed else 0).to_bytes(2, "little") + raw[at + 18 : at + 32] + body
    (tmp_path / "run.blf").write_bytes(raw[:at] + container + bytes(length % 4))
    assert "not a readable log: an object of 0 bytes is shorter than its header" in refused(path).problem


def test_a_log_that_crashes_its_reader(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = logged(tmp_path, ".mf4")
    raw = bytearray((tmp_path / "run.mf4").read_bytes())
    for block in re.finditer(b"##CN", bytes(raw)):  # channels: links from byte 24 on, then where in a record
        name = int.from_bytes(raw[block.start() + 40 :][:8], "little")
        if raw[name + 24 :].startswith(b"CAN_DataFrame.IDE\0"):
            raw[block.start() + 95] = 64  # a GiB further
    (tmp_path / "run.mf4").write_bytes(raw)
    assert "not a readable log" in refused(path).problem
    assert capfd.readouterr() == ("", "")


def test_a_log_whose_formula_is_code(tmp_path: Path) -> None:
    """MF4 converts channels by formulas; what reads them falls back on Python's own `eval`."""
    path, ran = logged(tmp_path, ".mf4"), tmp_path / "ran"
    with MDF(tmp_path / "run.mf4") as log:
        for channel in (c for group in log.groups for c in group.channels if c.name == "time"):
            formula = f"__import__('pathlib').Path('{ran}').touch() or X"
            channel.conversion = ChannelConversion(conversion_type=CONVERSION_TYPE_ALG, formula=formula)
        log.save(tmp_path / "formula.mf4")
    (tmp_path / "formula.mf4").replace(tmp_path / "run.mf4")
    ran.unlink(missing_ok=True)  # writing it may run it
    assert "formula" in refused(path).problem
    assert not ran.exists()


def test_a_log_whose_reader_comes_to_no_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = logged(tmp_path, ".mf4")
    (tmp_path / "can.py").write_text("def LogReader(path):\n    while True:\n        pass\n")
    monkeypatch.syspath_prepend(tmp_path)  # as the other process finds it; here it is loaded already
    monkeypatch.setattr(apart, "SILENCE_S", 0.2)
    assert "does not end" in refused(path).problem


def test_a_log_whose_frames_have_no_time(tmp_path: Path) -> None:
    path = logged(tmp_path, ".log")
    lines = (tmp_path / "run.log").read_text().split("\n")
    lines[5] = "(" + "9" * 400 + lines[5][lines[5].index(".") :]
    (tmp_path / "run.log").write_text("\n".join(lines))
    assert "not a readable log" in refused(path).problem


def test_a_dbc_that_scales_beyond_all_numbers(tmp_path: Path) -> None:
    path = logged(tmp_path, ".log")
    text = (tmp_path / "run.dbc").read_text()
    assert " SG_ velocity_hip m1 : 31|12@0+ (" in text
    head, _, rest = text.partition(" SG_ velocity_hip m1 : 31|12@0+ (")
    huge = f"{head} SG_ velocity_hip m1 : 31|12@0+ ({'9' * 400},{rest.partition(',')[2]}"
    (tmp_path / "run.dbc").write_text(huge)
    assert refused(path).file


@pytest.mark.parametrize("table", ["/etc/passwd", "../../../../etc/passwd", "/dev/zero", ".", "", "a\0b.csv"])
def test_a_table_is_a_file_of_a_table_s_kind(table: str, tmp_path: Path) -> None:
    error = refused(write_recording(tmp_path, table=table))
    assert "root:" not in str(error)


def test_names_cannot_talk_to_the_terminal(tmp_path: Path) -> None:
    columns = {**description()["columns"], "velocity": ["w_a", "\x1b[31m\u202e[red]"]}
    error = refused(write_recording(tmp_path, columns=columns))
    assert str(error).isprintable() and "[31m" in str(error)
    assert (
        len(str(refused(write_recording(tmp_path, columns={**columns, "velocity": ["w_a", "x" * 9999]}))))
        < 1300
    )


def test_a_link_to_itself(tmp_path: Path) -> None:
    path = write_recording(tmp_path)
    (tmp_path / "table.csv").unlink()
    (tmp_path / "table.csv").symlink_to(tmp_path / "table.csv")
    refused(path)
    path.unlink()
    path.symlink_to(path)
    refused(path)
