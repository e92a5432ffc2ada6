"""The verdict and the numbers at the top of the page, and where the error is beside the map."""

from __future__ import annotations

from workbench.core import Comparison
from workbench.report import wording as w
from workbench.report.comparison_words import comparison_sentence, loop_sentence
from workbench.report.numbers import number

from .widgets import safe

NOTHING_CHOSEN = (
    "<h1>Choose a model and recordings to begin.</h1><p class=quiet>Then see where the model is wrong, and "
    "find what is missing.</p>"
)
_SHARES = 5


def verdict(model: str, comparison: Comparison | None) -> str:
    """Return a comparison as one sentence; None while it is computed."""
    words = comparison_sentence(comparison) if comparison else "Comparing with the noise …"
    tone = "" if comparison is None else "good" if comparison.consistent else "missing"
    return f"<p class=eyebrow>{safe(model)}</p><h1 class='verdict {tone}'>{safe(words)}</h1>"


def numbers(error: float | None, given: float | None, floor: float | None) -> str:
    """Return the numbers that change with every change of the model."""
    cells = [("error", number(error) if error is not None else "…", "error")]
    if given is not None:
        cells.append(("as given", number(given), "given"))
    cells.append(("noise floor", number(floor) if floor is not None else "…", "floor"))
    if error is not None and floor:
        cells.append(("over the noise", w.times_noise(error, floor).replace(" times", " ×"), "times"))
    parts = "".join(
        f"<div><dt>{name}</dt><dd class='{kind}'>{safe(value)}</dd></div>" for name, value, kind in cells
    )
    return f"<dl class=numbers aria-live=polite>{parts}</dl>"


def where_words(comparison: Comparison) -> str:
    """Return the largest shares of the error of a comparison above the noise, as HTML."""
    shares = sorted(comparison.where, key=lambda s: -s.share)[:_SHARES]
    lines = "".join(f"<li>{safe(w.capital(w.share_phrase(s)))}</li>" for s in shares)
    if lines:
        told = (
            "<p>Largest parts of the squared error above the noise. Frequency, speed, position and time "
            f"divide the same error differently; do not add the parts.</p><ul>{lines}</ul>"
        )
    elif comparison.consistent:  # single cells of the map may exceed the noise
        told = "<p>As a whole, the error is no larger than the noise explains.</p>"
    else:
        told = "<p>The error is above the noise; no range of time, speed or position holds most of it.</p>"
    loop = loop_sentence(comparison)
    return told + (f"<p class=quiet>{safe(loop)}</p>" if loop else "")
