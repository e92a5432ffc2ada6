"""Logs of a CAN bus (candump .log, .blf, .asc, .mf4), decoded by the DBC file beside them."""

from __future__ import annotations

import contextlib
import logging
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core import InputError

from .apart import mf4_messages
from .blf import check_blf
from .missing import missing_column

if TYPE_CHECKING:
    import can

_LARGEST, _LATEST = 1e300, 1e12
_TIME, _VALID = ("t", "time"), "valid"


def read_can(path: Path, columns: Sequence[str]) -> dict[str, np.ndarray]:
    """Read the named signals; see `read_table`.

    A column is ``t`` (time stamps), ``valid``, or a signal: ``SIGNAL``, ``MESSAGE.SIGNAL``, either with its
    channel in front (``can0/MESSAGE.SIGNAL``). The first signal's frames are the rows; the others are brought
    to their time along straight lines between their own frames. Where a signal has no frame within half a row
    it is NaN, and ``valid`` is 0: nothing is held.

    Raises:
        InputError: no DBC, no such signal, or a log that cannot be read.
    """
    database = _database(path)
    wanted = [column for column in columns if column not in (*_TIME, _VALID)]
    signals = {column: _find(column, database, path) for column in wanted}
    series: dict[str, tuple[list[float], list[float]]] = {column: ([], []) for column in wanted}
    for message in _messages(path):
        _decode(message, signals, series)
    for column, (stamps, _) in series.items():
        if len(stamps) < 2:
            raise InputError(
                f"has {len(stamps)} frames in the log", file=path, column=column,
                remedy="check that it was sent",
            )  # fmt: skip
    if not wanted:
        raise InputError(
            "no signal is asked for", file=path, remedy="name signals of the DBC under [columns]"
        )
    rows = np.unique(np.array(series[wanted[0]][0]))
    half = 0.5 * float(np.median(np.diff(rows)))
    data = {column: _at(rows, *series[column], half) for column in wanted}
    valid = np.isfinite(np.column_stack(list(data.values()))).all(axis=1)
    data |= {name: rows - rows[0] for name in _TIME if name in columns}
    return data | ({_VALID: valid.astype(float)} if _VALID in columns else {})


def sent_signals(path: Path) -> dict[str, str]:
    """Return signals of the DBC that occur at least twice in a log: column -> unit (empty if unstated).

    Raises:
        InputError: no DBC, or a log that cannot be read.
    """
    database = _database(path)
    sent = Counter((m.arbitration_id, m.is_extended_id) for m in _messages(path))
    known = [m for m in database.messages if sent[(m.frame_id, m.is_extended_frame)] >= 2]
    every = Counter(s.name for m in database.messages for s in m.signals)
    return {
        s.name if every[s.name] == 1 else f"{m.name}.{s.name}": str(s.unit or "")
        for m in known
        for s in m.signals
    }


def _at(rows: np.ndarray, stamps: list[float], values: list[float], half: float) -> np.ndarray:
    """Return a signal at the rows' times (N,); NaN if it has no frame within `half` of a row [s]."""
    t, first = np.unique(np.array(stamps), return_index=True)
    x = np.array(values)[first]
    right = np.clip(np.searchsorted(t, rows), 1, len(t) - 1)
    near = np.minimum(np.abs(t[right] - rows), np.abs(t[right - 1] - rows)) <= half
    return np.where(near, np.interp(rows, t, x), np.nan)


def _decode(message: can.Message, signals: dict[str, Any], series: dict[str, Any]) -> None:
    import cantools.database

    read: dict[str, Any] | None = None
    for column, (channel, name, signal) in signals.items():
        if message.arbitration_id != name.frame_id or message.is_extended_id != name.is_extended_frame:
            continue
        if channel is not None and str(message.channel) != channel:
            continue
        if read is None:
            try:
                read = name.decode(bytes(message.data), decode_choices=False)
            except (cantools.database.DecodeError, ValueError, OverflowError):
                return
        if read is not None and signal in read:
            value = read[signal]
            if abs(value) < _LARGEST:  # a DBC may claim any scale
                series[column][0].append(message.timestamp)
                series[column][1].append(float(value))


def _find(column: str, database: Any, path: Path) -> tuple[str | None, Any, str]:
    """Return channel (None: any), message and signal name of a column."""
    channel, _, rest = column.rpartition("/")
    message, _, signal = rest.rpartition(".")
    found = [
        each
        for each in database.messages
        if (not message or each.name == message) and any(s.name == signal for s in each.signals)
    ]
    if len(found) > 1:
        names = ", ".join(each.name for each in found)
        raise InputError(f"'{signal}' is in {names}", file=path, column=column, remedy="write MESSAGE.SIGNAL")
    if not found:
        known = [f"{each.name}.{s.name}" for each in database.messages for s in each.signals]
        raise missing_column(column, known, path)
    return channel or None, found[0], signal


def dbc_of(path: Path) -> Path | None:
    """Return the DBC of a log: the one of the same name, or else the only one beside it."""
    own, others = path.with_suffix(".dbc"), sorted(path.parent.glob("*.dbc"))
    return own if own.is_file() else others[0] if len(others) == 1 else None


def _database(path: Path) -> Any:
    import cantools
    import cantools.database

    file = dbc_of(path)
    if file is None:
        remedy = f"put {path.with_suffix('.dbc').name} beside it ('workbench can dbc' writes one)"
        raise InputError("a CAN log needs a DBC file", file=path, remedy=remedy)
    # that two messages share a name or an identifier is said where one of them is asked for
    logging.getLogger("cantools").setLevel(logging.CRITICAL)
    try:
        return cantools.database.load_file(file, strict=False)
    except MemoryError:
        raise
    except Exception as error:  # its parser raises whatever it met
        raise InputError(f"is no DBC: {error}", file=file, remedy="export it again") from error


@contextlib.contextmanager
def _whole() -> Iterator[None]:
    """Refuse a log from which its reader skipped something with a warning: a recording has no silent gaps."""
    log, keep = logging.getLogger("can.io"), logging.Handler(logging.WARNING)
    before, keep.emit = (log.handlers, log.propagate), _refuse
    log.handlers, log.propagate = [keep], False
    try:
        yield
    finally:
        log.handlers, log.propagate = before


def _refuse(record: logging.LogRecord) -> None:
    if record.name == "can.io.blf":  # others leave nothing out
        raise ValueError(record.getMessage())


def _messages(path: Path) -> Iterator[can.Message]:
    """Yield the data frames of a log."""
    import can  # takes seconds to load, and most tables are no logs

    try:
        if path.suffix.lower() == ".mf4":
            reading = contextlib.closing(mf4_messages(path))
        else:
            if path.suffix.lower() == ".blf":
                check_blf(path)
            reading = can.LogReader(path)
        with _whole(), reading as messages:
            for message in messages:
                if not abs(message.timestamp) < _LATEST:
                    raise ValueError(f"a frame's time is {message.timestamp:g} s")
                if not (message.is_error_frame or message.is_remote_frame):
                    yield message
    except NotImplementedError as error:
        remedy = "convert it to .blf or .asc, or install asammdf"
        raise InputError("MF4 logs need asammdf", file=path, remedy=remedy) from error
    except MemoryError:
        raise
    except Exception as error:  # the readers of BLF, ASC and MF4 raise whatever their parsers met
        raise InputError(f"is not a readable log: {error}", file=path, remedy="export it again") from error
