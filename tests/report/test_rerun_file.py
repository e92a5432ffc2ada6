"""A result as a Rerun recording, read back by the reader of the package rerun-sdk."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from workbench.core import Comparison, Improvement, InputError
from workbench.report import write_rerun


def curves(file: Path) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Path -> times [s] and numbers."""
    from rerun.chunk import RrdReader

    found: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    for chunk in RrdReader(file).stream().to_chunks():
        batch = chunk.to_record_batch()
        if "time" in batch.schema.names:
            times = np.asarray(batch.column("time").cast("int64"), float) * 1e-9
            numbers = np.array([x for (x,) in batch.column("Scalars:scalars").to_pylist()])
            found[chunk.entity_path] = times, numbers
    return found


def test_measured_and_simulated_lie_in_one_plot(comparison: Comparison, tmp_path: Path) -> None:
    found = curves(write_rerun(comparison, tmp_path / "result.rrd"))
    for entry in comparison.recordings:
        real, valid = entry.recording, np.asarray(entry.recording.valid, bool)
        for k, axis in enumerate(real.axes):
            for what, signals in (("measured", real.signals), ("simulated", entry.simulated.signals)):
                times, numbers = found[f"/{real.name}/position/{axis}/{what}"]
                np.testing.assert_allclose(times, real.time[valid], atol=1e-9)
                np.testing.assert_array_equal(numbers, signals["position"][valid, k])
            _, rest = found[f"/{real.name}/residual/torque_measured/{axis}/residual"]
            np.testing.assert_array_equal(rest, entry.residual("torque_measured")[valid, k])


def test_an_improvement_has_the_run_with_its_effects_too(improvement: Improvement, tmp_path: Path) -> None:
    found = curves(write_rerun(improvement, tmp_path / "result.rrd"))
    assert improvement.after is not None
    simulated = improvement.after.recordings[0].simulated.signals["position"][:, 0]
    _, numbers = found["/chirp_hip/position/hip/simulated_with_effects"]
    assert numbers[0] == simulated[0] and "/chirp_hip/position/hip/simulated" in found


def test_nothing_is_overwritten_unasked(comparison: Comparison, tmp_path: Path) -> None:
    (tmp_path / "result.rrd").write_text("old")
    with pytest.raises(InputError, match="--force"):
        write_rerun(comparison, tmp_path / "result.rrd")
    assert (tmp_path / "result.rrd").read_text() == "old"


def test_without_the_package_one_line_says_what_to_install(
    comparison: Comparison, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(InputError, match="rerun-sdk"):
        write_rerun(comparison, tmp_path / "result.rrd")
    assert not list(tmp_path.iterdir())
