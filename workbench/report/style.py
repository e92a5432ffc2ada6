"""Style of all pictures, and how they are written; readable on a grey printer too."""

from __future__ import annotations

import base64
import io
import re
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from workbench.core import InputError
from workbench.core.files import check_free, write_whole
from workbench.core.palette import COLOURS, LINES

INK, BEFORE, AFTER, FLOOR = (COLOURS[name][0] for name in ("ink", "before", "after", "noise"))
QUIET, _RULE = COLOURS["quiet"][0], COLOURS["rule"][0]
#: How the line of a run is drawn.
LOOKS: dict[str, dict[str, Any]] = {name: LINES[name].drawn() for name in ("measured", "before", "after")}
LOOKS["measured"]["solid_capstyle"] = "butt"
_RC: Any = {
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.titleweight": "normal",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "axes.edgecolor": QUIET,
    "axes.labelcolor": INK,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "axes.grid": True,
    "grid.color": _RULE,
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "svg.fonttype": "none",
    "svg.hashsalt": "workbench",
    "figure.dpi": 120,
}

#: Formats of pictures, each with what keeps date and version out of the file.
_NO_DATE: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
}

_VARIABLES = {light: f"var(--{name})" for name, (light, _) in COLOURS.items()} | {"#ffffff": "var(--paper)"}


def house_style() -> AbstractContextManager[None]:
    """Give all figures that are made within the block the same style."""
    return mpl.rc_context(_RC)


def save_figure(figure: Figure, path: str | Path, *, force: bool = False) -> Path:
    """Write a figure as PNG, SVG or PDF, by the ending of the name, complete or not at all.

    Raises:
        InputError: another ending, the file exists and `force` is false, or it cannot be written.
    """
    check_figure(path)
    check_free(path, force=force)
    return write_whole(path, figure_bytes(figure, _kind(path)), force=force)


def check_figure(path: str | Path) -> None:
    """Refuse a file whose ending is not that of a picture that can be written.

    Raises:
        InputError: as it says.
    """
    if _kind(path) not in _NO_DATE:
        raise InputError(
            f"no picture can be written as '{Path(path).suffix}'", file=path,
            remedy="name it .png, .svg or .pdf",
        )  # fmt: skip


def _kind(path: str | Path) -> str:
    return Path(path).suffix.lower().lstrip(".")


def figure_bytes(figure: Figure, kind: str = "png", dpi: int = 160) -> bytes:
    """Return the figure as PNG, SVG or PDF; the bytes are the same at every call."""
    buffer = io.BytesIO()
    with mpl.rc_context(_RC):
        figure.savefig(buffer, format=kind, dpi=dpi, facecolor="white", metadata=_NO_DATE[kind])
    return buffer.getvalue()


def embedded(figure: Figure, dpi: int = 130) -> str:
    """Return the figure as a page holds it: a PNG in base64."""
    return base64.b64encode(figure_bytes(figure, "png", dpi)).decode("ascii")


def inline(figure: Figure) -> str:
    """Return the figure as SVG inside a page, in the colours of the page's scheme, light or dark."""
    svg = figure_bytes(figure, "svg").decode()
    svg = re.sub(r' xmlns(:xlink)?="[^"]*"', "", svg[svg.index("<svg") :])  # a page knows what SVG is
    svg = re.sub(
        r"<(metadata|style)\b.*?</\1>", "", svg, flags=re.DOTALL
    )  # a style would hold for the whole page
    return re.sub(r"#[0-9a-f]{6}(?=[;\"])", lambda found: _VARIABLES.get(found[0], found[0]), svg)
