"""What was identified as shells and notebooks show it."""

from __future__ import annotations

from matplotlib.figure import Figure

from workbench.core.shown import Summary, by_kind
from workbench.report.numbers import interval

from .links_page import axis_rows, link_rows, links_sentences
from .page import actuator_rows, readable
from .picture import actuator_figure, fit_figure, links_figure
from .result import ActuatorIdentification, LegIdentification, LinksIdentification

_HEAD = ("parameter", "estimate (95 %)")


summary = by_kind("identification")  # in a few lines
as_figure = by_kind("identification")


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


@summary.register
def _(value: LinksIdentification) -> Summary:
    sentence, *_ = links_sentences(value)
    return Summary(f"The links of {value.model}", sentence, [axis_rows(value), link_rows(value)])


@as_figure.register
def _(value: LinksIdentification) -> Figure:
    return links_figure(value)


@as_figure.register
def _(value: ActuatorIdentification) -> Figure:
    return actuator_figure(value)


@as_figure.register
def _(value: LegIdentification) -> Figure:
    return fit_figure(value.fit)
