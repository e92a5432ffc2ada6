"""A figure that a notebook shows by itself, whatever backend it has."""

from __future__ import annotations

from io import BytesIO

from matplotlib.figure import Figure

_DPI = 110


class Picture(Figure):
    """Matplotlib's figure; notebooks know those of pyplot only, and ours are made without it."""

    def _repr_png_(self) -> bytes:
        out = BytesIO()
        self.savefig(out, format="png", dpi=_DPI)
        return out.getvalue()
