"""Rows that are not compared are not drawn as rows without an error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.core import Comparison
from workbench.report.pack import plots
from workbench.report.residual_strip import residual_strips
from workbench.report.residuals import compared

ENDS = 40


def along(comparison: Comparison) -> Comparison:
    """The same along a measured motion: position is not scored, and the ends do not count."""
    entries = []
    for entry in comparison.recordings:
        torque = entry.simulated.signals["torque_measured"].copy()
        truth = entry.recording.signals["torque_measured"]
        torque[:ENDS], torque[-ENDS:] = truth[:ENDS], truth[-ENDS:]
        entries.append(
            replace(
                entry,
                simulated=entry.simulated.with_signals(torque_measured=torque),
                position_rmse=np.full(len(entry.position_rmse), np.nan),
            )
        )
    return replace(comparison, recordings=tuple(entries))


def test_ends_that_do_not_count_are_gaps(comparison: Comparison) -> None:
    result = along(comparison)
    entry = result.recordings[0]
    shown = compared(entry, "torque_measured")
    assert np.isnan(shown[:ENDS]).all() and np.isnan(shown[-ENDS:]).all()
    assert np.isfinite(shown[ENDS]).all()
    first = plots(result, None)[0]["recordings"][0]["gaps"][0]
    assert first == [0.0, (ENDS - 1) * entry.recording.period]
    strips = residual_strips(result, None)
    assert strips
    begins = float(strips.strips[0].path[1:].split()[0])
    assert begins > 0, "the line begins behind the rows that do not count"


def test_in_a_loop_an_error_of_zero_is_one(comparison: Comparison) -> None:
    entry = along(comparison).recordings[0]
    looped = replace(entry, position_rmse=comparison.recordings[0].position_rmse)
    assert (compared(looped, "torque_measured")[:ENDS] == 0.0).all()
