"""Measured and simulated signals as a Rerun recording, drawn one over the other."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from workbench.core import Recording, Result
from workbench.core.files import check_free, write_whole
from workbench.core.packages import need
from workbench.core.palette import COLOURS
from workbench.core.recording import AXIS_SIGNALS

from .series import Signals, series_of, si_units

#: What is drawn -> its colour in all pictures, on the dark paper that Rerun has.
_COLOUR = {
    "measured": COLOURS["measured"][1],
    "simulated": COLOURS["before"][1],
    "simulated_with_effects": COLOURS["after"][1],
    "residual": COLOURS["before"][1],
    "residual_with_effects": COLOURS["after"][1],
}


def check_rerun(path: str | Path) -> None:
    """Refuse a file that cannot be written for Rerun, before the work starts.

    Raises:
        InputError: the package that writes it is missing.
    """
    need("rerun", "a Rerun recording", "rerun-sdk", "'robot-workbench[rerun]'", path)


def write_rerun(result: Result, path: str | Path, *, force: bool = False) -> Path:
    """Write measured and simulated signals as one ``.rrd`` file, complete or not at all.

    Each recording has a tab with a plot of each signal of each axis, in which ``measured``, ``simulated``
    and, where effects were found, ``simulated_with_effects`` lie one over the other, and plots of the
    residuals. Paths are ``/NAME/SIGNAL/AXIS/measured`` and so on, times those of the recording [s], units SI.
    Rows that do not count and numbers that are not finite are left out.

    Args:
        result: with the comparisons in it; of a long log they hold the worst stretch.
        path: the file.
        force: overwrite a file that is there already.

    Raises:
        InputError: the file exists and `force` is false, or the package rerun-sdk is missing.
    """
    check_free(path, force=force)
    check_rerun(path)
    import rerun as rr
    import rerun.blueprint as rrb

    plots: dict[str, dict[str, rrb.TimeSeriesView]] = {}
    with TemporaryDirectory() as folder, rr.RecordingStream("workbench") as stream:
        file = Path(folder) / "result.rrd"
        stream.save(file)
        for name, what, recording, signals in series_of(result):
            looks = rr.SeriesLines(names=what.replace("_", " "), colors=int(f"{_COLOUR[what][1:]}ff", 16))
            for plot, title, time, values in _curves(what, recording, signals):
                place = f"/{name}/{plot}"
                plots.setdefault(name, {})[plot] = rrb.TimeSeriesView(origin=place, name=title)
                stream.log(f"{place}/{what}", looks, static=True)
                column, numbers = rr.TimeColumn("time", duration=time), rr.Scalars.columns(scalars=values)
                stream.send_columns(f"{place}/{what}", indexes=[column], columns=numbers)
        tabs = [rrb.Grid(*own.values(), name=name) for name, own in plots.items()]
        stream.send_blueprint(rrb.Blueprint(rrb.Tabs(*tabs)))
        stream.flush()
        stream.disconnect()
        return write_whole(path, file.read_bytes(), force=force)


def _curves(
    what: str, recording: Recording, signals: Signals
) -> Iterator[tuple[str, str, np.ndarray, np.ndarray]]:
    """Place and title of the plot of each signal and axis, and times and values that count, (M,) each."""
    rest = what.startswith("residual")
    for signal in (s for s in signals if s in AXIS_SIGNALS):
        units = si_units(recording, signal)
        for k, (axis, unit) in enumerate(zip(recording.axes, units, strict=True)):
            values = np.asarray(signals[signal])[:, k]
            rows = np.asarray(recording.valid, bool) & np.isfinite(values)
            if rows.any():
                title = f"{'residual ' if rest else ''}{signal.replace('_', ' ')} of {axis} [{unit}]"
                place = f"{'residual/' if rest else ''}{signal}/{axis}"
                yield place, title, recording.time[rows], values[rows]
