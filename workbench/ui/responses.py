"""Measured frequency responses, and those of the runs of the model by the same estimator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, Range1d

from workbench.core import InputError, Recording, SimulationError
from workbench.frf import Frf, estimate_postures, local_polynomial
from workbench.models import Model

from .plots import band, figure, line, set_range, span_of

LOOKS = ("before", "after", "closed_chain", "kin_only", "s3n_act", "s3n_full", "exact")


@dataclass(frozen=True)
class Responses:
    """One posture: measured response, and those of models.

    `models`: name, which is also the look, to response (F, ny, nu) at the measured lines.
    """

    measured: Frf
    models: dict[str, np.ndarray]


def responses(
    model: Model, recordings: Sequence[Recording], runs: Mapping[str, Sequence[Recording]]
) -> Responses:
    """Return the responses of the recording, and of runs of models on it.

    Args:
        model: the model as given, for closed chain and variants.
        recordings: measured; those that repeat a period count, or else all.
        runs: ``before`` and ``after`` to runs of the recordings.

    Raises:
        InputError: these recordings give no response.
    """
    periodic = [i for i, r in enumerate(recordings) if r.excitation.kind == "multisine"]
    used = periodic or list(range(len(recordings)))
    measured = _estimate([recordings[i] for i in used], bool(periodic))
    models: dict[str, np.ndarray] = {}
    for name, made in runs.items():
        same = [_in_place_of(recordings[i], made[i]) for i in used]
        own = _estimate(same, bool(periodic))
        if own.response.shape == measured.response.shape:
            models[name] = own.response
    return Responses(measured, models | _of_the_file(model, measured))


def _estimate(recordings: list[Recording], periodic: bool) -> Frf:
    if periodic:
        return estimate_postures(recordings)[0]
    return local_polynomial(recordings)


def _in_place_of(recording: Recording, run: Recording) -> Recording:
    """A run with the references of its recording, as if it had been measured."""
    signals = {k: v for k, v in run.signals.items() if k in recording.signals}
    return replace(recording, signals={**recording.signals, **signals})


def _of_the_file(model: Model, measured: Frf) -> dict[str, np.ndarray]:
    """Closed chain and variants, where the model states them."""
    from workbench.verification import model_responses  # loads Drake

    if model.closed_chain is None or measured.coordinates != "actuator":
        return {}
    try:
        return model_responses(model, measured)
    except (InputError, SimulationError):
        return {}


class ResponseView:
    """Magnitude and phase of one entry of the response."""

    def __init__(self) -> None:
        self.frequency = Range1d(start=0.1, end=100.0)
        self.magnitude = figure(
            height=210,
            x_axis_type="log",
            y_axis_type="log",
            x_range=self.frequency,
            y_range=Range1d(start=0.1, end=1.0),
        )
        self.phase = figure(
            height=190,
            x_axis_type="log",
            x_range=self.frequency,
            y_range=Range1d(start=-180, end=180),
            x_label="frequency [Hz]",
            y_label="phase [deg]",
        )
        self.magnitude.xaxis.visible = False
        self.points = ColumnDataSource({k: [] for k in ("f", "size", "low", "high", "phase")})
        self.lines = ColumnDataSource({"f": [], **{f"{n}{p}": [] for n in LOOKS for p in ("", "_phase")}})
        band(self.magnitude, self.points, "f", "low", "high", "noise", 0.35)
        self.drawn: dict[str, list[Any]] = {}
        for plot, column, part in ((self.magnitude, "size", ""), (self.phase, "phase", "_phase")):
            plot.scatter(
                "f", column, source=self.points, size=4.5, line_color=None, tags=["fill:measured", "dots"]
            )
            for name in reversed(LOOKS):
                drawn = line(plot, self.lines, "f", f"{name}{part}", name)
                self.drawn.setdefault(name, []).append(drawn)

    def show(self, found: Responses, i: int, j: int, variants: bool) -> list[str]:
        """Draw output `i` over input `j`, with closed chain and variants or without.

        Returns:
            The looks of the lines that are drawn.
        """
        frf = found.measured
        f, g = frf.frequency, frf.response[:, i, j]
        size = np.abs(g)
        half = frf.magnitude_interval()[1][:, i, j] - size
        sure = half < size
        angle = np.degrees(np.angle(g))
        self.points.data = {
            "f": f,
            "size": size,
            "low": np.maximum(size - half, 0.02 * size),
            "high": size + half,
            "phase": np.where(sure, angle, np.nan),
        }
        columns: dict[str, Any] = {"f": f}
        empty = np.full(len(f), np.nan)
        shown = [n for n in LOOKS if n in found.models and (variants or n in ("before", "after"))]
        for name in LOOKS:
            model = found.models.get(name)
            for drawn in self.drawn[name]:
                drawn.visible = name in shown
            entry = empty if model is None else model[:, i, j]
            turn = np.degrees(np.angle(entry))
            jump = np.abs(np.diff(turn, prepend=turn[:1])) > 180.0
            columns[name], columns[f"{name}_phase"] = np.abs(entry), np.where(jump, np.nan, turn)
        self.lines.data = columns
        out, into = frf.outputs[i], frf.inputs[j]
        self.magnitude.yaxis.axis_label = f"magnitude [{out.unit} / ({into.unit})]"
        set_range(self.frequency, float(f[0]) / 1.1, float(f[-1]) * 1.1)
        low, high = span_of(*(float(np.log10(x)) for x in np.quantile(size, [0.0, 1.0])))
        set_range(self.magnitude.y_range, 10**low, 10**high)
        set_range(self.phase.y_range, -190, 190)
        return shown
