"""The page of ``workbench frf``: measurement, closed chain and serial variants in one picture a posture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from workbench.core.text import counted
from workbench.report.numbers import number
from workbench.report.response import entry_panels, error_row, notes_of, posture_of, words_of
from workbench.report.sheet import Drawing, Panel, Section, Sheet, SheetTable
from workbench.report.wording import capital

from .responses import FrfComparison

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DRAWN = 6  # postures; more make a page that no one reads
_WITHIN = 1.5  # times the measurement's uncertainty at which a model counts as agreeing


def frf_sheet(model: str, found: Sequence[FrfComparison]) -> Sheet:
    """What a comparison of responses says.

    Args:
        model: its name.
        found: at least one, one entry per posture.
    """
    names = list(found[0].models)
    error = {n: _pooled([c.error[n] for c in found]) for n in names}
    noise = _pooled([c.noise for c in found])
    truth = "closed_chain" if "closed_chain" in names else min(names, key=lambda n: error[n])
    good = error[truth] <= _WITHIN * noise
    worst = max(found, key=lambda c: c.overall(truth))
    drawn = sorted(found, key=lambda c: -c.overall(truth))[:_DRAWN]
    lines = [
        f"The largest excess is at {worst.worst(truth):.3g} Hz."
        if not good
        else f"The measurement's own uncertainty is {percent_of(noise)}."
    ]
    if len(found) > len(drawn):
        lines.append(f"The {len(drawn)} postures with the largest error are drawn; the tables hold all.")
    return Sheet(
        kind="frequency responses",
        model=model,
        tone="consistent" if good else "missing_effect",
        sentence=_sentence(truth, error, noise, good),
        lines=tuple(lines),
        key_numbers=(
            *((capital(words_of(n)), percent_of(error[n]), f"{number(error[n] / noise, 2)} × the uncertainty")
              for n in _shown(error, truth)),
            ("Measurement", percent_of(noise), "its own uncertainty"),
            ("Lines", str(sum(len(c.frf) for c in found)), _span(found)),
        ),
        sections=(
            Section("errors", "Error of each model", tables=(_table(found),)),
            *(_section(c, k, len(drawn)) for k, c in enumerate(c for c in found if c in drawn)),
            *notes_of(c.frf for c in found),
        ),
    )  # fmt: skip


def percent_of(share: float) -> str:
    """Return a share in percent, two digits."""
    return f"{number(100 * share, 2)} %"


def _sentence(truth: str, error: dict[str, float], noise: float, good: bool) -> str:
    others = {n: e for n, e in error.items() if n != truth}
    named = "The closed chain" if truth == "closed_chain" else words_of(truth)
    verb = "agrees with the measured response to" if good else "misses the measured response by"
    times = f"{number(error[truth] / noise, 2)} times the measurement's uncertainty"
    beside = "within the measurement's uncertainty" if error[truth] <= noise else times
    how = f"{named} {verb} {percent_of(error[truth])}, {beside}"
    if not others:
        return f"{how}."
    best, last = min(others, key=others.__getitem__), max(others, key=others.__getitem__)
    tail = f", {words_of(last)} by {percent_of(others[last])}" if last != best else ""
    return f"{how}. Of the serial trees, {words_of(best)} misses it by {percent_of(others[best])}{tail}."


def _shown(error: dict[str, float], truth: str) -> list[str]:
    """The closed chain and the nearest and the farthest tree."""
    others = sorted((n for n in error if n != truth), key=lambda n: error[n])
    return [truth, *dict.fromkeys([*others[:1], *others[-1:]])]


def _pooled(parts: Sequence[np.ndarray]) -> float:
    return float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))


def _span(found: Sequence[FrfComparison]) -> str:
    low = min(c.frf.frequency[0] for c in found)
    high = max(c.frf.frequency[-1] for c in found)
    return f"{low:.3g} to {high:.3g} Hz"


def _table(found: Sequence[FrfComparison]) -> SheetTable:
    several = len(found) > 1
    rows = [
        (
            words_of(name),
            *([posture_of(c.frf)] if several else []),
            percent_of(c.overall(name)),
            number(c.overall(name) / c.overall_noise, 3),
            f"{c.worst(name):.3g} Hz",
        )
        for c in found
        for name in c.models
    ]
    return SheetTable(
        "Relative error of every model over all lines and entries, and the line with the largest excess",
        (
            "Model",
            *(["Posture"] if several else []),
            ">Relative error",
            ">Times the uncertainty",
            ">Worst at",
        ),
        tuple(rows),
    )


def frf_figure(comparison: FrfComparison) -> Figure:
    """Return response and models at one posture as a picture; see `frf_panels`."""
    from workbench.report.sheet_picture import panels_figure  # slow to import, and only pictures need it

    return panels_figure(frf_panels(comparison))


def frf_panels(c: FrfComparison) -> list[Panel]:
    """Return a panel per entry with magnitude, phase and error, and where there are several, all errors."""
    panels = entry_panels(c.frf, c.models)
    if len(panels) > 1:
        low = 0.3 * min([float(np.min(c.noise)), *(float(np.median(e)) for e in c.error.values())])
        words = ", ".join(f"{words_of(n)} {percent_of(c.overall(n))}" for n in c.models)
        words = words or f"the measurement's own {percent_of(c.overall_noise)}"
        whole = Panel(
            "All entries together",
            "frequency [Hz]",
            (error_row("relative error [%]", c.frf.frequency, c.noise, c.error, low),),
            f"Relative error of all entries together, root mean square: {words}.",
            wide=True,
        )
        panels.append(whole)
    return panels


def _section(c: FrfComparison, number_: int, count: int) -> Section:
    what = c.frf.outputs[0].signal
    caption = (
        f"From {c.frf.inputs[0].signal.replace('_', ' ')} to {what}. Grey: 95 % of the measurement's "
        "magnitude and phase, and under the errors the part that its own uncertainty explains. Where "
        f"noise dominates, no phase is drawn. {counted(c.frf.periods, 'period')}, "
        f"{counted(c.frf.realisations, 'realisation')}."
    )
    return Section(
        f"posture-{number_ + 1}",
        "Response" if count == 1 else f"Response {number_ + 1}",
        sentences=(f"About {posture_of(c.frf)} ({c.frf.coordinates} coordinates).",),
        drawings=(Drawing(tuple(frf_panels(c)), caption),),
    )
