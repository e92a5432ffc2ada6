"""What was identified as shells and notebooks show it."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from matplotlib.figure import Figure

from workbench.core.shown import Summary
from workbench.report.numbers import interval

from .page import actuator_rows, readable
from .picture import actuator_figure, fit_figure
from .result import ActuatorIdentification, LegIdentification

_HEAD = ("parameter", "estimate (95 %)")


@singledispatch
def summary(value: Any) -> Summary:
    """Return the numbers with their intervals, and whether the model explains the response."""
    raise TypeError(f"a {type(value).__name__} is no identification")


@singledispatch
def as_figure(value: Any) -> Figure:
    """Return the measured response and the fit."""
    raise TypeError(f"a {type(value).__name__} is no identification")


@summary.register
def _(value: ActuatorIdentification) -> Summary:
    title = f"The drive of {value.frf.inputs[0].axis}"
    return Summary(title, value.fit.sentence, [(_HEAD, actuator_rows(value))])


@summary.register
def _(value: LegIdentification) -> Summary:
    named = {"M11": value.M11, "M12": value.M12, "M22": value.M22, "delay": value.delay}
    axes = [channel.axis for channel in value.frfs[0].inputs]
    for name, pair in (("damping", value.damping), ("gravity", value.gravity)):
        named |= {f"{name} {axis}": x for axis, x in zip(axes, pair, strict=True)}
    rows = [(name, interval(readable(x))) for name, x in named.items()]
    return Summary("The leg, in actuator coordinates", value.fit.sentence, [(_HEAD, rows)])


@as_figure.register
def _(value: ActuatorIdentification) -> Figure:
    return actuator_figure(value)


@as_figure.register
def _(value: LegIdentification) -> Figure:
    return fit_figure(value.fit)
