"""Logs in JSON: a list of records, lists by name, or one record per line; what is nested becomes ``a.b``."""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core import InputError
from workbench.core.bounds import check_cells, opened, read_bounded

from ..table import Table
from .joint_names import named_by_text, of_list
from .written_time import stamps

_WIDE = 64  # numbers of one list in a record; more is a picture, not a joint
_DEEP = 6
_FEW = 8  # records make a log

Cell = float | str
Row = dict[str, Cell]


def read_json(path: Path) -> Table:
    """Read a log in JSON.

    Raises:
        InputError: it is no JSON, too large, or no list of eight records or numbers is in it.
    """
    try:
        with opened(path) as file:
            content = _parsed(read_bounded(file, path).decode("utf-8-sig"))
    except (OSError, EOFError, zlib.error, ValueError, RecursionError) as error:
        raise InputError("is not readable JSON", file=path, remedy="check that the file is whole") from error
    found = sorted(_tables("", content, 0), key=lambda rows: -len(rows[1]))
    if not found:
        remedy = "give a list of records, lists of numbers by name, or one record per line"
        raise InputError("holds no list of eight or more records or numbers", file=path, remedy=remedy)
    where, rows = found[0]
    names = list(dict.fromkeys(name for row in rows for name in row))
    check_cells(len(names) * len(rows), path)
    columns: dict[str, np.ndarray] = {}
    texts: dict[str, list[str]] = {}
    for name in names:
        cells = [row.get(name, np.nan) for row in rows]
        numbers = _numbers(cells)
        if numbers is None:
            texts[name] = ["" if cell != cell else str(cell) for cell in cells]
        else:
            columns[name] = numbers
    if not columns:
        raise InputError("holds no numbers", file=path, remedy="give one record per sample")
    table = named_by_text(Table(path, columns), names, texts)
    joints = of_list(columns, dict(_name_lists("", content, 0)))
    table = replace(table, joints={**joints, **table.joints})
    left = _beside(content, where, [name for name, _ in found[1:]])
    return replace(table, notes=(*table.notes, f"Not read: {', '.join(left)}.")) if left else table


def _parsed(text: str) -> Any:
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        if error.msg != "Extra data":
            raise
    return [json.loads(line) for line in text.splitlines() if line.strip()]


def _tables(where: str, value: Any, depth: int) -> Iterator[tuple[str, list[Row]]]:
    """Every list of records or numbers, and lists by name of one length, with the path to it."""
    if isinstance(value, list) and len(value) >= _FEW:
        if all(isinstance(item, Mapping) for item in value):
            yield where, [dict(_flat("", item, 0)) for item in value]
        elif all(isinstance(item, list) for item in value):
            head = value[0] if all(isinstance(cell, str) for cell in value[0]) else []
            names = [str(cell) for cell in head] or [f"column_{i + 1}" for i in range(len(value[0]))]
            rows = [dict(zip(names, item, strict=False)) for item in value[bool(head) :]]
            yield where, [dict(_flat("", row, 0)) for row in rows]
    elif isinstance(value, Mapping):
        lists = dict(_lists("", value, 0))
        lengths = [len(items) for items in lists.values()]
        if lengths:
            length = max(set(lengths), key=lambda n: (lengths.count(n), n))
            same = {name: items for name, items in lists.items() if len(items) == length}
            rows = [dict(zip(same, cells, strict=True)) for cells in zip(*same.values(), strict=True)]
            yield where, [dict(_flat("", row, 0)) for row in rows]
        for key, item in value.items():
            if depth < _DEEP and isinstance(item, list | Mapping) and not _is_numbers(item):
                inner = f"{where}.{key}".lstrip(".")
                if isinstance(item, list) or not lists:
                    yield from _tables(inner, item, depth + 1)


def _lists(prefix: str, value: Mapping[str, Any], depth: int) -> Iterator[tuple[str, list[Any]]]:
    for key, item in value.items():
        name = f"{prefix}.{key}".lstrip(".")
        if isinstance(item, Mapping) and depth < _DEEP:
            yield from _lists(name, item, depth + 1)
        elif isinstance(item, list) and _is_numbers(item):
            yield name, item


def _name_lists(prefix: str, value: Any, depth: int) -> Iterator[tuple[str, list[str]]]:
    """Every list of texts, wherever it stands."""
    for key, item in value.items() if isinstance(value, Mapping) else ():
        name = f"{prefix}.{key}".lstrip(".")
        if isinstance(item, list) and item and all(isinstance(text, str) for text in item):
            yield name, item
        elif depth < _DEEP:
            yield from _name_lists(name, item, depth + 1)


def _is_numbers(value: Any) -> bool:
    """Whether a value is a column: of numbers, or of short rows of numbers."""
    if not isinstance(value, list) or len(value) < _FEW:
        return False
    return all(
        item is None
        or isinstance(item, int | float)
        or (isinstance(item, list) and all(isinstance(cell, int | float) for cell in item))
        for item in value
    )


def _flat(prefix: str, value: Any, depth: int) -> Iterator[tuple[str, Cell]]:
    """Names and cells of one record; of lists beside a list of names, they are named after those."""
    if isinstance(value, bool | int | float):
        yield prefix, _float(value)
    elif isinstance(value, str):
        yield prefix, value
    elif isinstance(value, list) and len(value) <= _WIDE and depth < _DEEP:
        for i, item in enumerate(value):
            yield from _flat(f"{prefix}[{i}]", item, depth + 1)
    elif isinstance(value, Mapping) and depth < _DEEP:
        joints = value.get("name", value.get("names"))
        named = isinstance(joints, list) and all(isinstance(joint, str) for joint in joints)
        for key, item in value.items():
            name = f"{prefix}.{key}".lstrip(".")
            if named and isinstance(item, list) and len(item) == len(joints):
                if item is not joints:
                    for joint, cell in zip(joints, item, strict=True):
                        yield from _flat(f"{prefix}.{joint}.{key}".lstrip("."), cell, depth + 1)
            else:
                yield from _flat(name, item, depth + 1)


def _float(value: float) -> float:
    try:
        return float(value)
    except OverflowError:  # JSON has integers of any length
        return np.nan


def _numbers(cells: Sequence[Cell]) -> np.ndarray | None:
    """Cells as floats, written times as seconds; None where they are text."""
    text = [isinstance(cell, str) and cell != "" for cell in cells]
    if not any(text):
        return np.array([np.nan if isinstance(cell, str) else cell for cell in cells], float)
    try:
        return np.array([np.nan if cell == "" else cell for cell in cells], float)  # numbers in quotes
    except ValueError:
        return stamps([cell if isinstance(cell, str) else None for cell in cells])


def _beside(content: Any, where: str, others: Sequence[str]) -> list[str]:
    """Names of what stands beside the table that was read."""
    out, value = [other for other in others if other], content
    path = ""
    for key in where.split(".") if where else []:
        out += [f"{path}{k}" for k in value if k != key and f"{path}{k}" not in out]
        value, path = value[key], f"{path}{key}."
    if not where and isinstance(content, Mapping):
        out += [k for k, v in content.items() if not isinstance(v, list | Mapping)]
    return out
