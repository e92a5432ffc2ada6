"""An inspection as shells and notebooks show it: what is or may be wrong, and what is worth knowing."""

from __future__ import annotations

from matplotlib.figure import Figure

from workbench.core.palette import LINES
from workbench.core.picture import Picture
from workbench.core.shown import Summary

from .result import Inspection


def summary(value: Inspection) -> Summary:
    """Return its remarks without the passed checks; equal remarks of several recordings appear once."""
    found: dict[tuple[str, str], list[str]] = {}
    for r in value.recordings:
        for m in r.remarks:
            if m.severity != "ok":
                found.setdefault((m.severity, m.text), []).append(r.recording)
    rows = [
        (severity, text, ", ".join(names) if len(names) < len(value.recordings) else "all")
        for (severity, text), names in found.items()
    ]
    title = "Nothing is wrong with these recordings." if value.sound else "Something is wrong, or may be."
    return Summary(title, "", [(("", "what the data say", "recordings"), rows)])


def as_figure(value: Inspection, *, recording: int = 0) -> Figure:
    """Return a figure of the range and the band in which each axis of a recording moved."""
    excited = value.recordings[recording].excited
    figure = Picture(figsize=(7.2, 0.5 * len(excited) + 1.2), layout="constrained")
    places = figure.subplots(1, 2, sharey=True)
    line = LINES["measured"]
    for k, e in enumerate(excited):
        for ax, (low, high) in zip(places, (e.position_range, e.band_hz), strict=True):
            ax.plot([low, high], [k, k], color=line.light, lw=6, solid_capstyle="butt")
    places[0].set(
        xlabel="position [rad or m]", yticks=range(len(excited)), yticklabels=[e.axis for e in excited]
    )
    places[1].set(xlabel="98 % of the speed's power within [Hz]", xscale="log")
    places[0].invert_yaxis()
    return figure
