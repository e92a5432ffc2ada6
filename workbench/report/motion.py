"""A page with a moving robot and curves; it needs no other file and no network."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from workbench.core import InputError
from workbench.core.files import check_free, write_whole

from .numbers import rounded
from .shell import reproduce, template

_POINTS = 600  # of a curve


@dataclass(frozen=True)
class Panel:
    """Curves over one horizontal axis.

    Attributes:
        title: with the unit.
        across: what it is over, with the unit.
        x: (N,).
        curves: name -> values (N,).
        moves: whether x is the time of the motion, so that a line marks it.
    """

    title: str
    across: str
    x: np.ndarray
    curves: Mapping[str, np.ndarray]
    moves: bool = True


def motion_page(
    title: str, lines: Sequence[str], time: np.ndarray, ends: np.ndarray, panels: Sequence[Panel],
    command: str, inputs: Sequence[str | Path],
) -> str:  # fmt: skip
    """Return the page as HTML.

    Args:
        title: what is shown.
        lines: what is said of it.
        time: of the frames (F,) [s].
        ends: of the robot's lines (F, L, 2, 3) [m].
        panels: curves.
        command: that makes the page again.
        inputs: files that it shows.
    """
    data = {
        "time": np.round(time, 4).tolist(),
        "ends": np.round(ends.reshape(len(ends), -1), 4).tolist(),
        "panels": [_panel(each) for each in panels],
    }
    return template("motion.html.j2").render(
        kind="motion",
        model=title,
        tone="neutral",
        sentence=title,
        lines=list(lines),
        key_numbers=[],
        data=data,
        reproduce=reproduce(command, None, inputs),
    )


def film(file: Path, time: np.ndarray, ends: np.ndarray, *, force: bool = False) -> None:
    """Write the same motion as an mp4.

    Raises:
        InputError: as `check_film`; the file exists and `force` is false, or it cannot be written.
    """
    check_film(file)
    check_free(file, force=force)
    from matplotlib.animation import FFMpegWriter
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    figure = Figure(figsize=(6.4, 4.8))
    axes: Any = figure.add_subplot(projection="3d")
    low, high = ends.min(axis=(0, 1, 2)), ends.max(axis=(0, 1, 2))
    middle, half = 0.5 * (low + high), 0.5 * max(float((high - low).max()), 1e-3)
    axes.set(**{f"{k}lim": (c - half, c + half) for k, c in zip("xyz", middle, strict=True)})
    bars = Line3DCollection(ends[0], linewidths=3)
    axes.add_collection3d(bars)
    writer = FFMpegWriter(fps=round((len(time) - 1) / max(float(time[-1] - time[0]), 1e-6)))
    with TemporaryDirectory() as folder:
        made = Path(folder) / "film.mp4"
        with writer.saving(figure, str(made), dpi=100):
            for frame in ends:
                bars.set_segments(frame)
                writer.grab_frame()
        write_whole(file, made.read_bytes(), force=force)


def check_film(file: str | Path) -> None:
    """Refuse a film that cannot be made, before the work starts.

    Raises:
        InputError: its name does not end in .mp4, or ffmpeg is not installed.
    """
    if Path(file).suffix.lower() != ".mp4":
        raise InputError("a film is written as MP4", file=file, remedy="name it .mp4")
    if shutil.which("ffmpeg") is None:
        raise InputError("ffmpeg is not installed", file=file, remedy="install it, or write the page alone")


def _panel(panel: Panel) -> dict[str, Any]:
    step = max(1, len(panel.x) // _POINTS)
    return {
        "title": panel.title,
        "across": panel.across,
        "moves": panel.moves,
        "x": rounded(panel.x[::step], 5),
        "curves": [[name, rounded(np.asarray(values)[::step], 5)] for name, values in panel.curves.items()],
    }
