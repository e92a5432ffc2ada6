"""MCAP files and ROS 2 bags: one series per topic, one column per joint and quantity."""

from __future__ import annotations

import io
import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import redirect_stderr
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core import InputError
from workbench.core.bounds import MOST_BYTES, MOST_CELLS, inside, too_large

from ..merge import merged
from ..table import LoggedSeries, Table

_WIDE = 64  # numbers of one array in a message; more is a picture, not a joint
_QUANTITIES = (("position", "position"), ("velocity", "velocity"), ("effort", "effort"))
_NEEDS = "install it with: pip install 'robot-workbench[logs]'"

#: Topic, log time [ns], message.
Messages = Iterator[tuple[str, int, Any]]


def read_mcap_file(path: Path) -> Table:
    """Return the series of an MCAP file with ROS 2 or JSON messages."""
    return _table(path, _mcap_messages(path))


def read_bag(folder: Path) -> Table:
    """Return the series of a ROS 2 bag: the folder with ``metadata.yaml``, its storage SQLite or MCAP."""
    files = sorted(folder.glob("*.mcap"))
    if files:
        messages = (m for file in files for m in _mcap_messages(inside(folder, file)))
        return _table(folder, messages)
    return _table(folder, _sqlite_messages(folder))


def _table(path: Path, messages: Messages) -> Table:
    series = _series(path, messages)
    if not series:
        raise InputError(
            "holds no messages with numbers that can be read", file=path,
            remedy="record sensor_msgs/JointState, std_msgs/Float64MultiArray or JSON",
        )  # fmt: skip
    origin = min(float(each.stamps[0]) for each in series)
    series = [replace(each, stamps=each.stamps - origin) for each in series]
    known = Table(path, {}, {"log time": "s"}, clock="log time")
    return merged(known, series, "log time")


def _series(path: Path, messages: Messages) -> list[LoggedSeries]:
    stamps: dict[tuple[str, frozenset[str]], list[float]] = {}
    rows: dict[tuple[str, frozenset[str]], list[dict[str, float]]] = {}
    cells = 0
    for topic, log_time, message in messages:
        row = dict(_numbers(topic.strip("/"), message))
        if not row:
            continue
        cells += len(row)
        if cells > MOST_CELLS // 8:  # held as Python numbers here
            raise too_large(path)
        key = topic, frozenset(row)
        stamps.setdefault(key, []).append(_stamp(message, log_time))
        rows.setdefault(key, []).append(row)
    out = []
    for together in _publishers(list(rows)):
        found = [row for key in together for row in rows[key]]
        times = np.array([stamp for key in together for stamp in stamps[key]])
        names = dict.fromkeys(name for row in found for name in row)
        columns = {name: np.array([row.get(name, np.nan) for row in found]) for name in names}
        order = np.argsort(times, kind="stable")
        out.append(LoggedSeries(times[order], {n: c[order] for n, c in columns.items()}))
    return out


def _publishers(keys: list[tuple[str, frozenset[str]]]) -> list[list[tuple[str, frozenset[str]]]]:
    """Messages of one series: of one topic, with columns in common.

    Drivers of different joints publish on one topic, each by its own clock.
    """
    groups: list[tuple[str, set[str], list[tuple[str, frozenset[str]]]]] = []
    for topic, names in keys:
        same = [g for g in groups if g[0] == topic and g[1] & names]
        groups = [g for g in groups if g not in same]
        joined = [key for g in same for key in g[2]]
        groups.append((topic, set(names).union(*(g[1] for g in same)), [*joined, (topic, names)]))
    return [members for _, _, members in groups]


def _stamp(message: Any, log_time: int) -> float:
    """The time of measurement where the message has one, else the time of logging [s]."""
    stamp = _get(_get(message, "header"), "stamp")
    seconds, nanoseconds = _get(stamp, "sec"), _get(stamp, "nanosec")
    if isinstance(seconds, int) and isinstance(nanoseconds, int) and seconds + nanoseconds > 0:
        return seconds + 1e-9 * nanoseconds
    return log_time * 1e-9


def _numbers(prefix: str, message: Any) -> Iterator[tuple[str, float]]:
    """Names and numbers of a message; a joint's are named after the joint."""
    names = _get(message, "name")
    if names is not None and _get(message, "position") is not None and not isinstance(names, str):
        for field, word in _QUANTITIES:
            values = _get(message, field)
            for name, value in zip(
                list(names)[:_WIDE], list(values if values is not None else ()), strict=False
            ):
                yield f"{prefix}/{name}.{word}", float(value)
        return
    yield from _flat(prefix, message, 0)


def _flat(prefix: str, value: Any, depth: int) -> Iterator[tuple[str, float]]:
    if isinstance(value, bool | int | float | np.number):
        yield prefix, float(value)
    elif isinstance(value, np.ndarray | list | tuple):
        if len(value) <= _WIDE:
            for i, item in enumerate(value):
                yield from _flat(f"{prefix}[{i}]", item, depth + 1)
    elif depth < 5 and not isinstance(value, str | bytes) and value is not None:
        for key, item in _fields(value):
            if key not in ("header", "layout") and not key.startswith("_"):
                yield from _flat(prefix if key == "data" else f"{prefix}.{key}", item, depth + 1)


def _fields(value: Any) -> Iterable[tuple[str, Any]]:
    if isinstance(value, Mapping):
        return [(str(k), v) for k, v in value.items()]
    names = getattr(value, "__slots__", None) or vars(value)
    return [(name, getattr(value, name, None)) for name in names]


def _get(value: Any, key: str) -> Any:
    if isinstance(value, Mapping):
        return value.get(key)
    return getattr(value, key, None)


def _mcap_messages(path: Path) -> Messages:
    try:
        from mcap.reader import NonSeekingReader
        from mcap_ros2.decoder import DecoderFactory
    except ImportError as error:
        raise InputError("MCAP needs the package mcap", file=path, remedy=_NEEDS) from error
    decoders: dict[int, Any] = {}
    factory = DecoderFactory()
    try:
        with path.open("rb") as file:
            reader = NonSeekingReader(file, record_size_limit=MOST_BYTES)
            for schema, channel, message in reader.iter_messages():
                if channel.id not in decoders:
                    json_text = channel.message_encoding == "json"
                    with redirect_stderr(io.StringIO()):  # it prints what it then raises
                        found = (
                            json.loads if json_text else factory.decoder_for(channel.message_encoding, schema)
                        )
                    decoders[channel.id] = found
                if decode := decoders[channel.id]:
                    yield channel.topic, message.log_time, decode(message.data)
    except MemoryError:
        raise
    except Exception as error:  # readers, unpackers and decoders have no common root of their errors
        raise InputError(
            f"is not a readable MCAP file: {error}", file=path, remedy="record it again"
        ) from error


def _sqlite_messages(folder: Path) -> Messages:
    try:
        from rosbags.rosbag2 import Reader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise InputError("ROS 2 bags need the package rosbags", file=folder, remedy=_NEEDS) from error
    for file in folder.iterdir():
        inside(folder, file)
    metadata = (folder / "metadata.yaml").read_bytes()[: 2**20].decode("utf-8", "replace").lower()
    if "compression_mode: file" in metadata:
        # a packed file may unpack to any size on the disk
        remedy = "unpack it with 'ros2 bag convert', or record it with --compression-mode message"
        raise InputError("the bag's files are compressed as a whole", file=folder, remedy=remedy)
    # types that ROS itself defines, none that the bag brings along: those would be made into code
    store = get_typestore(Stores.ROS2_HUMBLE)
    try:
        with Reader(folder) as bag:
            known = [c for c in bag.connections if c.msgtype in store.fielddefs]
            if not known:
                return
            for connection, stamp, raw in bag.messages(connections=known):
                yield connection.topic, stamp, store.deserialize_cdr(raw, connection.msgtype)
    except MemoryError:
        raise
    except Exception as error:  # the database's own errors have no common root with the reader's
        raise InputError(f"is not a readable bag: {error}", file=folder, remedy="record it again") from error
