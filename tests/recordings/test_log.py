"""A log that stays in its file gives the rows that reading all of it would."""

from __future__ import annotations

import gzip
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow.csv as pacsv
import pyarrow.parquet as pq
import pytest
from long_logs import write_log

import workbench.recordings.log
from workbench.core import InputError, Recording
from workbench.recordings import Log, excerpts, load_recording, open_recordings


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Nine seconds of three axes, as Parquet."""
    return write_log(tmp_path_factory.mktemp("log"), "walk", 9.0, legs=1)


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Callable[[Path], Log]:
    """Opens a recording as what is too long to be held."""
    for name, value in (("HELD", 1000), ("SMALL", 0), ("SMALL_TEXT", 0)):
        monkeypatch.setattr(workbench.recordings.log, name, value)

    def as_log(path: Path) -> Log:
        (source,) = open_recordings(path)
        assert isinstance(source, Log)
        return source

    return as_log


def as_table(written: Path, folder: Path, ending: str, change: Callable[[str], str] = str) -> Path:
    """The same recording with its table in another format."""
    table = pq.read_table(written.with_suffix(".parquet"))
    path = folder / f"walk.{ending}"
    if ending == "parquet":
        pq.write_table(table, path, row_group_size=len(table))
    else:
        pacsv.write_csv(table, folder / "plain.csv")
        text = change((folder / "plain.csv").read_text()).encode()
        path.write_bytes(gzip.compress(text) if ending.endswith("gz") else text)
    toml = folder / "walk.toml"
    toml.write_text(written.read_text().replace("walk.parquet", path.name))
    return toml


@pytest.mark.parametrize(("name", "at"), [("HELD", 1), ("HELD_COUPLED", 2)])
def test_a_log_begins_where_rows_and_axes_are_too_many(
    name: str, at: int, written: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workbench.recordings.log, "SMALL", 0)
    whole = load_recording(written)
    numbers = len(whole) * len(whole.axes) ** at
    for least, kind in ((numbers, Recording), (numbers - 1, Log)):
        monkeypatch.setattr(workbench.recordings.log, name, least)
        assert isinstance(open_recordings(written)[0], kind)


@pytest.mark.parametrize("ending", ["parquet", "csv", "csv.gz"])
def test_pieces_are_the_rows_of_the_whole(
    ending: str, written: Path, tmp_path: Path, opened: Callable[[Path], Log]
) -> None:
    path = as_table(written, tmp_path, ending)
    whole, log = load_recording(path), opened(path)
    assert (log.rows, log.axes, log.duration) == (len(whole), whole.axes, pytest.approx(whole.duration))
    after = 0
    for piece in log.stretches(2.0, 0.5):
        first = round(piece.start / whole.period)
        assert first + piece.lead == after and first % 3 == 0  # the loop ticks every third row
        after = first + len(piece.recording)
        for name, values in piece.recording.signals.items():
            assert np.array_equal(values, whole.signals[name][first:after])
        assert piece.recording.timing.initial_at_rest is (first == 0)
    assert after == len(whole)


def test_a_bad_cell_is_named_by_its_row_in_the_whole(
    written: Path, tmp_path: Path, opened: Callable[[Path], Log]
) -> None:
    def spoilt(text: str) -> str:
        lines = text.splitlines()
        cells = lines[7001].split(",")
        cells[3] = "broken"
        return "\n".join([*lines[:7001], ",".join(cells), *lines[7002:]])

    log = opened(as_table(written, tmp_path, "csv", spoilt))
    with pytest.raises(InputError, match="'broken' is not a number") as caught:
        list(log.stretches(2.0))
    assert caught.value.row == 7001


def test_windows_are_where_something_happens_and_spread(
    written: Path, tmp_path: Path, opened: Callable[[Path], Log]
) -> None:
    # 27 s, of which all but the last two of every nine stand still
    table = pq.read_table(written.with_suffix(".parquet")).to_pandas()
    quiet = table["t"] < 6.9
    moving = [c for c in table if c != "t"]
    table.loc[quiet, moving] = table.loc[0, moving].to_numpy()
    many = table.loc[np.tile(np.arange(len(table)), 3)].assign(t=0.001 * np.arange(3 * len(table)))
    many.to_parquet(tmp_path / "walk.parquet")
    (tmp_path / "walk.toml").write_text(written.read_text())
    log = opened(tmp_path / "walk.toml")
    chosen = excerpts([log], at_once=54_000.0)  # six seconds of three axes
    assert all(isinstance(r, Recording) and not r.timing.initial_at_rest for r in chosen.training)
    starts = [float(r.name.split(", ")[1].split()[0]) for r in chosen.training]
    assert starts == sorted(starts) and len(starts) == 4
    assert {int(s // 9) for s in starts} == {0, 1, 2}
    lively = [r for r in chosen.training if np.ptp(r.position) > 0.01]
    assert len(lively) >= 3
    assert chosen.share == pytest.approx(8.0 / 27.0, rel=0.02)
    assert "of 27 s, 4 windows of 2 s" in chosen.notes[0]


def test_what_is_short_stays_as_it_is(written: Path) -> None:
    (source,) = open_recordings(written)
    chosen = excerpts([source])
    assert chosen.training[0] is source and chosen.share == 1.0 and not chosen.notes
