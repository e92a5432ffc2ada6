"""Names of joints that stand in the rows of a log: one per column of numbers, or one per row."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..merge import merged
from ..names import role_of
from ..table import LoggedSeries, Table

_MOST = 64  # joints; a column with more values says something else
_NAMES = ("name", "names", "joint", "jointname", "motor", "axis", "id", "device", "servo")


def named_by_text(table: Table, names: Sequence[str], texts: Mapping[str, Sequence[str]]) -> Table:
    """Return a table of numbers, with joints named by its text; a note lists other text, which is left out.

    Args:
        table: the columns of numbers.
        names: of all columns, in the file's order.
        texts: the columns of text, each of (N,) cells.
    """
    whole = {
        n: [f"{v:.0f}" for v in values]
        for n, values in table.columns.items()
        if set(role_of(n).words) & set(_NAMES)
        and len(np.unique(values)) <= _MOST
        and np.array_equal(values, np.round(values))
    }
    rows = of_rows(table.columns, {**texts, **whole})
    told = of_columns(names, table.columns, texts) if rows is None else rows[1]
    used = (
        {rows[2]} if rows else {n for n, cells in texts.items() if told and set(cells) <= set(told.values())}
    )
    left = [n for n in texts if n not in used]
    notes = list(table.notes)
    if len(left) == 1:
        notes.append(f"Column '{left[0]}' holds text and is left out.")
    elif left:
        notes.append(f"Columns of text are left out: {', '.join(left)}.")
    if rows is not None:
        series, told, name, time = rows[0], rows[1], rows[2], rows[3]
        notes.append(
            f"Each row holds the one joint that '{name}' names; the rows were merged into rows of all joints."
        )
        unit = {time: table.units[time]} if time in table.units else {}
        units = {n: table.units[k] for n in told if (k := n.partition(".")[2]) in table.units}
        base = Table(table.file, {}, {**units, **unit}, notes=tuple(notes), joints=told)
        return merged(base, series, time)
    return replace(table, notes=tuple(notes), joints=told)


def of_columns(
    names: Sequence[str], columns: Mapping[str, np.ndarray], texts: Mapping[str, Sequence[str]]
) -> dict[str, str]:
    """Return column -> joint, where columns of text name the joints and are constant.

    ``name0, name1, position0, position1`` tells by its numbers which joint a column is of; without a header
    the joints stand first and then one number each, quantity after quantity.

    Args:
        names: of all columns, in the file's order.
        columns: those of numbers.
        texts: those of text.
    """
    same = {n: next(iter(set(cells))) for n, cells in texts.items() if len(set(cells)) == 1}
    by_number = {number: joint for n, joint in same.items() if "name" in _stem(n) and (number := _number(n))}
    if len(set(by_number.values())) > 1:
        return {n: by_number[number] for n in columns if (number := _number(n)) in by_number}
    counted = [n for n in same if re.fullmatch(r"column_\d+", n)]
    if len(counted) < 2 or len({same[n] for n in counted}) < len(counted):
        return {}
    first = names.index(counted[0])
    after = [n for n in names[first + len(counted) :] if n in columns]
    if list(names[first : first + len(counted)]) != counted or len(after) % len(counted):
        return {}
    return {n: same[counted[k % len(counted)]] for k, n in enumerate(after)}


def of_list(columns: Collection[str], lists: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Return column -> joint, where a list of names stands beside arrays: ``q[0]``, ``q[1]``.

    Args:
        columns: names of the columns.
        lists: name -> texts of each list in the file.
    """
    for name, joints in lists.items():
        words = set(role_of(name).words)
        if not words & set(_NAMES) and not any(word.removesuffix("s") in _NAMES for word in words):
            continue
        if 1 < len(joints) <= _MOST and len(set(joints)) == len(joints):
            stems = {n.rpartition("[")[0] for n in columns if re.fullmatch(r".+\[\d+\]", n)}
            whole = [s for s in stems if sum(n.startswith(f"{s}[") for n in columns) == len(joints)]
            if whole:
                return {f"{s}[{i}]": joint for s in whole for i, joint in enumerate(joints)}
    return {}


def of_rows(
    columns: Mapping[str, np.ndarray], texts: Mapping[str, Sequence[str]]
) -> tuple[list[LoggedSeries], dict[str, str], str, str] | None:
    """Return one series per joint, where each row names its joint; None where a row holds all joints.

    Args:
        columns: of numbers, each (N,).
        texts: of text, or of whole numbers as text.

    Returns:
        The series, column -> joint, the column that names the joints, and the one of time.
    """
    for name, cells in texts.items():
        if not set(role_of(name).words) & set(_NAMES):
            continue
        joints = list(dict.fromkeys(cells))
        time = _time(columns, cells, joints) if 1 < len(joints) <= _MOST and "" not in joints else None
        if time is None:
            continue
        told, series = {}, []
        for joint in joints:
            rows = np.array([cell == joint for cell in cells])
            of_joint = {
                f"{joint}.{n}": values[rows]
                for n, values in columns.items()
                if n not in (time, name) and np.isfinite(values[rows]).any()
            }
            told |= dict.fromkeys(of_joint, joint)
            order = np.argsort(columns[time][rows], kind="stable")
            stamps = columns[time][rows][order]
            series.append(LoggedSeries(stamps, {n: values[order] for n, values in of_joint.items()}))
        return _together(series), told, name, time
    return None


def _together(series: list[LoggedSeries]) -> list[LoggedSeries]:
    """Joints of the same stamps as one series."""
    first = series[0]
    if not all(np.array_equal(s.stamps, first.stamps) for s in series):
        return series
    return [LoggedSeries(first.stamps, {n: v for s in series for n, v in s.columns.items()})]


def _time(columns: Mapping[str, np.ndarray], cells: Sequence[str], joints: Sequence[str]) -> str | None:
    """The clock on which every joint has rows over the whole log; None where one comes after another."""
    rows = [np.flatnonzero([cell == joint for cell in cells]) for joint in joints]
    if min(map(len, rows)) < 8:
        return None
    for name, values in columns.items():
        if role_of(name).kind != "time":
            continue
        if not all(np.isfinite(values[r]).any() for r in rows):
            continue
        spans = [(float(np.nanmin(values[r])), float(np.nanmax(values[r]))) for r in rows]
        shared = min(last for _, last in spans) - max(begin for begin, _ in spans)
        if shared > 0.5 * (max(last for _, last in spans) - min(begin for begin, _ in spans)):
            return name
    return None


def _number(name: str) -> str:
    found = re.search(r"(\d+)\D?$", name)
    return found[1] if found else ""


def _stem(name: str) -> tuple[str, ...]:
    return role_of(name).words
