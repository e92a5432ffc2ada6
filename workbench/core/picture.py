"""A figure that a notebook shows without any backend setting, and strings in figures."""

from __future__ import annotations

from io import BytesIO

from matplotlib.figure import Figure

from .text import plain

_DPI = 110


class Picture(Figure):
    """Matplotlib's figure; notebooks show only figures of pyplot, and this package does not use pyplot."""

    def _repr_png_(self) -> bytes:
        out = BytesIO()
        self.savefig(out, format="png", dpi=_DPI)
        return out.getvalue()


def printed(words: str) -> str:
    """Return a string from a file as matplotlib should print it: dollars are dollars."""
    return plain(words).replace("$", r"\$")
