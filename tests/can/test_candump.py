"""Logs: what is written is read, by us and by python-can, and a log cut anywhere is readable."""

from __future__ import annotations

from pathlib import Path

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.can.test_frame import FLEXIBLE, FRAMES
from workbench.can import Frame
from workbench.can.candump import Logged, line, packed, read_candump
from workbench.core import InputError

LOGGED = st.lists(
    st.builds(
        Logged,
        st.integers(0, 10**15).map(lambda us: us / 1e6),
        st.sampled_from(["can0", "can1"]),
        st.one_of(FRAMES, FLEXIBLE),
    ),
    max_size=8,
)


@given(LOGGED, st.integers(0, 40))
def test_a_log_comes_back_to_its_last_whole_line(tmp_path_factory, frames, cut) -> None:
    path = tmp_path_factory.mktemp("log") / "a.log"
    text = "".join(line(*entry) for entry in frames)
    path.write_text(text[: max(0, len(text) - cut)])
    got = list(read_candump(path))
    whole = text[: max(0, len(text) - cut)].count("\n")
    assert len(got) == whole
    for read, wrote in zip(got, frames, strict=False):
        assert read[1:] == wrote[1:] and read.stamp == pytest.approx(wrote.stamp, abs=1e-6)


def test_python_can_reads_the_log_and_the_archive(tmp_path: Path) -> None:
    frames = [Logged(100.0 + k, f"can{k % 2}", Frame(k << 20 | 7, bytes([k]) * k, k > 0)) for k in range(8)]
    frames.append(Logged(110.0, "can0", Frame(0x8001, bytes(range(48)), True, fd=True)))
    path, blf = tmp_path / "a.log", tmp_path / "a.blf"
    path.write_text("".join(line(*entry) for entry in frames))
    count, content = packed(path)
    assert count == 9 and blf.write_bytes(content)
    for reader in (can.CanutilsLogReader(path), can.BLFReader(blf)):
        got = [(m.arbitration_id, m.is_extended_id, bytes(m.data), m.is_fd) for m in reader]
        assert got == [(e.frame.id, e.frame.extended, e.frame.data, e.frame.fd) for e in frames]


def test_what_is_no_log_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text("(1.0) can0 123#00\nhello\n(2.0) can0 123#00\n")
    with pytest.raises(InputError, match="row 2"):
        list(read_candump(path))
    with pytest.raises(InputError, match="cannot be read"):
        list(read_candump(tmp_path / "none.log"))
