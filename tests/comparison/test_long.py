"""A long log compared in stretches: what comparing all of it at once says, in memory that does not grow."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from long_logs import Rubbing, write_log, write_model

import workbench.comparison.long
import workbench.comparison.survey
import workbench.recordings.log
from workbench.comparison import compare, compare_logs
from workbench.effects import load_model
from workbench.models import Model
from workbench.recordings import Log, load_recording, open_recordings


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Model:
    return load_model(write_model(tmp_path_factory.mktemp("model"), legs=1))


@pytest.fixture(autouse=True)
def short_is_long(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (("HELD", 1000), ("SMALL", 0)):
        monkeypatch.setattr(workbench.recordings.log, name, value)
    monkeypatch.setattr(workbench.comparison.long, "NUMBERS", 6_000)  # two seconds of three axes


def test_stretches_leave_what_the_whole_leaves(model: Model, tmp_path: Path) -> None:
    path = write_log(tmp_path, "walk", 12.0, legs=1, hidden=Rubbing("fl_knee", 0.2))
    beside = load_recording(write_log(tmp_path, "beside", 3.0, legs=1, seed=1))
    sources = [*open_recordings(path), beside]
    assert isinstance(sources[0], Log)
    short, whole = compare_logs(model, sources), compare(model, [load_recording(path), beside])
    assert short.error == pytest.approx(whole.error, rel=1e-3)
    assert short.noise_error == pytest.approx(whole.noise_error, rel=0.03)
    assert not short.consistent and not whole.consistent
    for a, b in zip(short.recordings, whole.recordings, strict=True):
        assert a.position_rmse == pytest.approx(b.position_rmse, rel=1e-2)
        assert a.torque_rmse == pytest.approx(b.torque_rmse, rel=1e-2)
        assert a.recording.name == b.recording.name
    assert short.recordings[0].covers == pytest.approx(12.0, abs=0.01) and short.recordings[1].covers is None
    assert short.inverse_dynamics is not None and whole.inverse_dynamics is not None
    assert short.inverse_dynamics.relative_error == pytest.approx(
        whole.inverse_dynamics.relative_error, rel=0.05
    )
    same = {(s.axis, s.signal, s.quantity) for s in short.where[:3]}
    assert same & {(s.axis, s.signal, s.quantity) for s in whole.where[:3]}
    assert any("all 12 s compared, in 6 stretches" in note for note in short.notes)


def test_a_right_model_is_right_in_stretches_too(model: Model, tmp_path: Path) -> None:
    told = compare_logs(model, open_recordings(write_log(tmp_path, "walk", 12.0, legs=1, hidden=None)))
    assert told.consistent and told.error == pytest.approx(told.noise_error, rel=0.05)


def test_memory_does_not_grow_with_the_log(
    model: Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # what is kept of a log, however long it is, at these lengths
    monkeypatch.setattr(workbench.comparison.long, "KEPT", 1000)
    monkeypatch.setattr(workbench.comparison.survey, "SAMPLED", 1)
    peaks = []
    for seconds in (3.0, 3.0, 8.0):  # once to load what is loaded once
        sources = open_recordings(write_log(tmp_path, f"walk{len(peaks)}", seconds, legs=1))
        tracemalloc.start()
        compare_logs(model, sources)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    # The clock grows, and what waits for the garbage collector comes on top: some 200 bytes a row. Held as a
    # whole a row of three axes takes two thousand and more.
    grown = (peaks[2] - peaks[1]) / 5_000
    assert grown < 600, f"{grown:.0f} bytes a row"
    assert np.isfinite(peaks).all()
