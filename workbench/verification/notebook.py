"""Frequency responses as shells and notebooks show them."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from workbench.core.shown import Summary, by_kind
from workbench.core.text import counted
from workbench.frf import Frf
from workbench.report.numbers import number
from workbench.report.response import posture_of, words_of

from .page import frf_figure, percent_of
from .responses import FrfComparison, uncertainty_of

summary = by_kind("frequency response")  # in a few lines
as_figure = by_kind("frequency response")


@summary.register
def _(value: Frf) -> Summary:
    size = np.abs(value.response)
    rows = [
        (
            f"{value.outputs[i].axis} over {value.inputs[j].axis}",
            f"{number(size[:, i, j].min())} to {number(size[:, i, j].max())}",
            f"{value.outputs[i].unit} / ({value.inputs[j].unit})",
        )
        for i, j in np.ndindex(size.shape[1:])
    ]
    span = f"{number(value.frequency[0])} to {number(value.frequency[-1])} Hz"
    told = f"{counted(value.periods, 'period')}, {counted(value.realisations, 'realisation')}."
    title = f"Frequency response about {posture_of(value)}: {counted(len(value), 'line')}, {span}"
    return Summary(title, told, [(("entry", "magnitude", "unit"), rows)])


@summary.register
def _(value: FrfComparison) -> Summary:
    rows = [(words_of(n), percent_of(value.overall(n)), f"{number(value.worst(n))} Hz") for n in value.models]
    title = f"Frequency response about {posture_of(value.frf)} beside {counted(len(rows), 'model')}"
    told = f"The uncertainty of the measurement is {percent_of(value.overall_noise)}."
    return Summary(title, told, [(("model", "relative error", "largest excess at"), rows)])


@as_figure.register
def _(value: Frf) -> Figure:
    return frf_figure(FrfComparison(value, {}, {}, uncertainty_of(value)))


@as_figure.register
def _(value: FrfComparison) -> Figure:
    return frf_figure(value)
