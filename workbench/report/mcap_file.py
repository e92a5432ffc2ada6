"""Measured and simulated signals as MCAP, which Foxglove and PlotJuggler open."""

from __future__ import annotations

import heapq
import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core import Recording, Result
from workbench.core.files import check_free, write_whole
from workbench.core.packages import need
from workbench.core.recording import AXIS_SIGNALS

from .series import Signals, series_of, si_units

#: Time [ns], channel, JSON.
_Message = tuple[int, int, bytes]


def check_mcap(path: str | Path) -> None:
    """Refuse a file that cannot be written as MCAP, before the work starts.

    Raises:
        InputError: the package that writes it is missing.
    """
    need("mcap.writer", "MCAP", "mcap", "'robot-workbench[logs]'", path)


def write_mcap(result: Result, path: str | Path, *, force: bool = False) -> Path:
    """Write measured and simulated signals as one MCAP file, complete or not at all.

    Each recording has the topics ``/NAME/measured``, ``/NAME/simulated`` and ``/NAME/residual`` (measured
    minus simulated), and where effects were found ``/NAME/simulated_with_effects`` and
    ``/NAME/residual_with_effects``. A message is JSON, ``{"position": {"hip": 0.1, "knee": 0.2}, ...}``, in
    the SI units that the schema of its topic names. Times are those of the recording, whose first row is 0.
    Rows that do not count and numbers that are not finite are left out.

    Args:
        result: with the comparisons in it; of a long log they hold the worst stretch.
        path: the file.
        force: overwrite a file that is there already.

    Raises:
        InputError: the file exists and `force` is false, or the package mcap is missing.
    """
    check_free(path, force=force)
    check_mcap(path)
    from mcap.writer import Writer

    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start(library="workbench")
    series: list[Iterator[_Message]] = []
    for name, what, recording, signals in series_of(result):
        topic = f"/{name}/{what}"
        schema = json.dumps(_schema(recording, signals)).encode()
        schema_id = writer.register_schema(f"workbench{topic.replace('/', '.')}", "jsonschema", schema)
        series.append(_messages(writer.register_channel(topic, "json", schema_id), recording, signals))
    for time, channel, message in heapq.merge(*series):
        writer.add_message(channel, time, message, time)
    writer.finish()
    return write_whole(path, stream.getvalue(), force=force)


def _schema(recording: Recording, signals: Signals) -> dict[str, Any]:
    """JSON schema of a topic's messages, each number with its SI unit as description."""

    def of_signal(name: str) -> dict[str, Any]:
        numbers = {
            axis: {"type": "number", "description": unit}
            for axis, unit in zip(recording.axes, si_units(recording, name), strict=True)
        }
        return {"type": "object", "properties": numbers}

    known = {name: of_signal(name) for name in signals if name in AXIS_SIGNALS}
    return {"type": "object", "properties": known}


def _messages(channel: int, recording: Recording, signals: Signals) -> Iterator[_Message]:
    known = {name: np.asarray(rows) for name, rows in signals.items() if name in AXIS_SIGNALS}
    stamps = np.rint(recording.time * 1e9).astype(np.int64)
    for i in np.flatnonzero(recording.valid):
        message = {
            name: {axis: float(x) for axis, x in zip(recording.axes, rows[i], strict=True) if np.isfinite(x)}
            for name, rows in known.items()
        }
        yield int(stamps[i]), channel, json.dumps(message).encode()
