"""Logs of a CAN bus with the DBC beside them: the signals that were sent, under the names of the DBC."""

from __future__ import annotations

from pathlib import Path

from workbench.core import InputError
from workbench.recordings.tables.can_table import read_can, sent_signals

from ..names import role_of
from ..table import Table


def read_can_log(path: Path) -> Table:
    """Return every signal of the DBC that was sent twice or more, at the frames of a measured position.

    Raises:
        InputError: no DBC, or a log that cannot be read.
    """
    signals = sent_signals(path)
    if not signals:
        raise InputError("no signal of the DBC was sent", file=path, remedy="check that it is the right DBC")
    found = {name: role_of(name.rpartition(".")[2]) for name in signals}
    first = [n for n, r in found.items() if r.kind == "position" and r.role != "reference"]
    order = sorted(signals, key=lambda n: n not in first)
    columns = read_can(path, ["t", *order, "valid"])
    units = {name: unit for name, unit in signals.items() if unit}
    return Table(path, columns, {**units, "t": "s"}, True, "t")
