"""The page of ``workbench diagnose --trace``: everything that the search tried, as drawing and tables."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from workbench.core import Diagnosis, Tried
from workbench.core.palette import COLOURS
from workbench.core.picture import Picture

from . import wording as w
from .answer import diagnosis_sentence
from .ladder import log_axis
from .numbers import number, percent
from .sheet import Section, Sheet, SheetTable
from .style import house_style
from .trace import trace_table


def trace_sheet(result: Diagnosis) -> Sheet:
    """Return a trace's page: a drawing, a table of what was tried, alternatives of each effect."""
    trace = result.trace
    first = (
        "Each line starts from a model and adds effects. Its result becomes the best so far if it "
        "explains the recordings and the best does not, or if it leaves less than half of the excess "
        "error of the best, or if it is as good and simpler."
        if trace
        else "Nothing was searched: the model explains the recordings as it is."
    )
    return Sheet(
        kind="trace",
        model=result.model,
        tone="missing_effect" if result.verdict == "partly_explained" else result.verdict,
        sentence=diagnosis_sentence(result),
        lines=(first,),
        key_numbers=(
            ("Tried", str(len(trace)), "models, in this order"),
            ("Accepted", str(sum(t.taken for t in trace)), "became the best so far"),
        ),
        sections=(_tried(trace), *_rivals(trace)) if trace else (),
    )


def trace_figure(trace: Sequence[Tried]) -> Figure:
    """Return a figure: error over noise of everything that was tried, one line each, in the order tried."""
    with house_style():
        figure = Picture(figsize=(7.2, 0.9 + 0.42 * len(trace)), layout="constrained")
        ax = figure.subplots()
        for row, t in enumerate(trace):
            colour = COLOURS["after" if t.taken else "quiet"][0]
            ax.plot(t.times_noise, [row] * len(t.times_noise), "-", color=colour, lw=1.4)
            ax.plot(t.times_noise[:-1], [row] * (len(t.times_noise) - 1), ".", color=colour, ms=5)
            ax.plot(
                t.times_noise[-1],
                row,
                "o",
                ms=7,
                color=colour,
                markerfacecolor=colour if t.taken else "white",
            )
        ax.axvline(1.0, color=COLOURS["noise"][0], ls=(0, (1, 2)))
        ax.set_yticks(range(len(trace)), [f"{k}. {t.move}" for k, t in enumerate(trace, 1)])
        ax.set_ylim(len(trace) - 0.4, -0.6)
        ax.set_xscale("log")
        axis = log_axis([1.0, *(x for t in trace for x in t.times_noise)])
        ax.set_xlim(axis.low, axis.high)
        ax.set_xticks(axis.ticks, [f"{x:g}" for x in axis.ticks])
        ax.xaxis.set_minor_locator(NullLocator())
        ax.set_xlabel("error / noise floor of the fitted recordings (dotted: the noise)")
        ax.set_title("One small dot per effect added; last dot filled: accepted")
    return figure


def _tried(trace: Sequence[Tried]) -> Section:
    picture = trace_figure(trace), _words(trace)
    return Section("tried", "What was tried", tables=(trace_table(trace),), picture=picture)


def _rivals(trace: Sequence[Tried]) -> tuple[Section, ...]:
    rows = []
    for k, t in enumerate(trace, 1):
        for key, rivals in t.added:
            others = [f"{w.effect_phrase(r)} {percent(share)}" for r, share in rivals if r != key]
            if others:
                rows.append((f"{k}. {w.capital(w.effect_phrase(key))}", "; ".join(others)))
    if not rows:
        return ()
    caption = "Share of the squared error above the noise that each effect removes by itself at this step"
    table = SheetTable(caption, ("Effect added", "Other effects that were fitted in its place"), tuple(rows))
    return (Section("rivals", "The candidates for each effect", tables=(table,)),)


def _words(trace: Sequence[Tried]) -> str:
    last = next((t for t in reversed(trace) if t.taken), trace[-1])
    left = number(last.times_noise[-1])
    return f"{len(trace)} models were tried; the last accepted one has an error of {left} times the noise."
