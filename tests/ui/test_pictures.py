"""What the diagrams draw is what is there."""

from __future__ import annotations

import numpy as np
import pytest

from tests.report import build
from workbench.ui.curves import Curves, thinned
from workbench.ui.residual_map import residual_map


def test_thinning_keeps_peaks_and_gaps() -> None:
    rng = np.random.default_rng(0)
    values = rng.normal(size=60_000)
    values[31_234] = 50.0
    values[10_000:12_000] = np.nan
    times, thin = thinned(values, 0.001, 500)
    assert len(thin) < 2000 and np.nanmax(thin) == 50.0
    assert abs(times[np.nanargmax(thin)] - 31.734) < 0.1
    inside = (times > 10.6) & (times < 12.4)
    assert inside.any() and np.isnan(thin[inside]).all() and np.isfinite(thin[times < 10.4]).all()


def test_the_map_shows_friction_where_the_knee_moves() -> None:
    entries = build.comparison(0.0).recordings
    found = residual_map(entries, ("hip", "knee"), "speed", 0)
    assert found.rows == (("hip", "position"), ("hip", "torque"), ("knee", "position"), ("knee", "torque"))
    hip, knee = found.ratio[1], found.ratio[3]
    assert np.nanmax(np.abs(hip - 1.0)) < 0.5
    expected = np.hypot(1.0, 0.25 / build.NOISE["torque_measured"])
    assert np.nanmedian(knee) == pytest.approx(expected, rel=0.1)
    whole = residual_map(entries, ("hip", "knee"), "time", 1)
    assert whole.edges[0, 0] < 0.1 and whole.edges[0, -1] > 11.9


def test_a_motion_that_was_given_has_no_residual_to_look_at() -> None:
    """Where the loop is unknown a model follows the measured motion: its residual of zero would be praise."""
    entry = build.comparison(0.0).recordings[0]
    given = entry.recording.with_signals(torque_measured=entry.simulated.signals["torque_measured"])
    curves = Curves()
    curves.time.update(start=0.0, end=1.0)
    curves.show(entry.recording, 0, given, None, None)
    assert [plot.visible for plot in curves.figures] == [True, False, True, True]
    assert curves.figures[0].yaxis.axis_label == "position, given [rad]"
    curves.show(entry.recording, 0, entry.simulated, None, None)
    assert all(plot.visible for plot in curves.figures)
    assert curves.figures[0].yaxis.axis_label == "position [rad]"


def test_rows_that_do_not_count_along_a_motion_are_no_run() -> None:
    """At the ends, where differentiating errs, a run has the measured torque: its curve would be praise."""
    entry = build.comparison(0.0).recordings[0]
    measured = entry.recording.signals["torque_measured"]
    needed = entry.simulated.signals["torque_measured"].copy()
    needed[:300] = measured[:300]
    curves = Curves()
    curves.time.update(start=0.0, end=1.0)
    curves.show(entry.recording, 0, entry.recording.with_signals(torque_measured=needed), None, None)
    last = round(0.5 * 299 * entry.recording.period / curves.time.end * len(curves._sources[2].data["t"]))
    drawn = np.asarray(curves._sources[2].data["before"], float)
    assert np.isnan(drawn[: max(last, 1)]).all() and np.isfinite(drawn).any()
