"""A figure that a notebook shows without any backend setting."""

from __future__ import annotations

from io import BytesIO

from matplotlib.figure import Figure

_DPI = 110


class Picture(Figure):
    """Matplotlib's figure; notebooks show only figures of pyplot, and this package does not use pyplot."""

    def _repr_png_(self) -> bytes:
        out = BytesIO()
        self.savefig(out, format="png", dpi=_DPI)
        return out.getvalue()
