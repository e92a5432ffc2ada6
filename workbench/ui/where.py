"""Where the error is, in words beside the map."""

from __future__ import annotations

from workbench.core import Comparison
from workbench.report import wording as w

from .widgets import safe

_SHARES = 5


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
    loop = w.loop_sentence(comparison)
    return told + (f"<p class=quiet>{safe(loop)}</p>" if loop else "")
