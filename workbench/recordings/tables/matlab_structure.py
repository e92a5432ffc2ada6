"""Whether a MATLAB file of version 5 to 7 is put together as its own tags say.

The reader that is used computes addresses from these tags, and ends the process where they are wrong. Format:
MathWorks, "MAT-File Format", chapter 1 (version 5).
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from workbench.core import InputError
from workbench.core.bounds import MOST_BYTES, MOST_CELLS, read_bounded, too_large

_HEAD = 128
_MATRIX, _COMPRESSED, _INT8, _INT32, _UINT32 = 14, 15, 1, 5, 6
#: Bytes of an item by the type of its element.
_ITEM = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8, 16: 1, 17: 2, 18: 4}
_CELL, _STRUCT, _OBJECT, _CHAR, _SPARSE, _FIRST_NUMBER, _LAST_NUMBER = 1, 2, 3, 4, 5, 6, 15
_DEEPEST = 20  # structs in one another


class _Element(NamedTuple):
    kind: int
    data: memoryview


class _Damaged(Exception):
    """Tags that contradict each other."""


def check_matlab(path: Path) -> None:
    """Walk through a file's tags; files of version 4 have none, and those of 7.3 are refused by their reader.

    Raises:
        InputError: it contradicts itself, or would unpack to more than a table may have.
    """
    try:
        with path.open("rb") as file:
            raw = read_bounded(file, path)
    except OSError as error:
        raise _unreadable(path) from error
    if len(raw) < _HEAD or 0 in raw[:4] or raw[125 if raw[126:127] == b"I" else 124] == 2:
        return
    # as the reader has it: what is not little-endian is taken for the other
    order = "<" if raw[126:128] == b"IM" else ">"
    left = [MOST_BYTES]
    try:
        for element in _elements(memoryview(raw)[_HEAD:], order):
            if element.kind == _COMPRESSED:
                inner = list(_elements(memoryview(_unpacked(element.data, left, path)), order))
                if len(inner) != 1:
                    raise _Damaged
                element = inner[0]
            if element.kind != _MATRIX:
                raise _Damaged
            _check_array(element.data, order, path, 0)
    except (_Damaged, struct.error, zlib.error, StopIteration) as error:
        raise _unreadable(path) from error


def _unreadable(path: Path) -> InputError:
    return InputError("is not a readable MATLAB file", file=path, remedy="check that the file is whole")


def _elements(data: memoryview, order: str) -> Iterator[_Element]:
    at = 0
    while at < len(data):
        word, size = struct.unpack_from(f"{order}II", data, at)
        if word >> 16:  # up to four bytes in the tag itself
            kind, size, start, after = word & 0xFFFF, word >> 16, at + 4, at + 8
            if size > 4:
                raise _Damaged
        else:
            kind, start = word, at + 8
            after = start + size if kind == _COMPRESSED else start + -(-size // 8) * 8
        if start + size > len(data):
            raise _Damaged
        yield _Element(kind, data[start : start + size])
        at = after


def _check_array(data: memoryview, order: str, path: Path, depth: int) -> None:
    if not len(data):
        return  # an array without anything, as structs have where nothing was put in
    if depth > _DEEPEST:
        raise _Damaged
    parts = _elements(data, order)
    flags, dims, name = next(parts), next(parts), next(parts)
    if flags.kind != _UINT32 or len(flags.data) != 8 or name.kind not in (_INT8, 2, 16):
        raise _Damaged
    word = struct.unpack_from(f"{order}I", flags.data)[0]
    kind, complex_ = word & 0xFF, bool(word & 0x800)
    if kind > _LAST_NUMBER:
        return  # functions and objects of MATLAB's own, which are not read
    if dims.kind != _INT32 or len(dims.data) < 8 or len(dims.data) % 4 or len(dims.data) > 4 * 32:
        raise _Damaged
    shape = struct.unpack(f"{order}{len(dims.data) // 4}i", dims.data)
    count = math.prod(shape)
    if min(shape) < 0:
        raise _Damaged
    if count > MOST_CELLS:
        raise too_large(path)
    if kind in (_CELL, _STRUCT, _OBJECT):
        _check_inner(parts, kind, count, order, path, depth)
        return
    numbers = [next(parts) for _ in range(2 if kind == _SPARSE else 0)]
    numbers += [next(parts) for _ in range(1 + complex_)] if count or kind == _SPARSE else []
    for each in numbers:
        item = _ITEM.get(each.kind)
        if item is None or len(each.data) % item:
            raise _Damaged
        if kind >= _FIRST_NUMBER and len(each.data) // item != count:
            raise _Damaged
        if kind == _CHAR and len(each.data) > 4 * count:
            raise _Damaged


def _check_inner(
    parts: Iterator[_Element], kind: int, count: int, order: str, path: Path, depth: int
) -> None:
    fields = 1
    if kind == _OBJECT:
        next(parts)
    if kind in (_STRUCT, _OBJECT):
        length, names = next(parts), next(parts)
        if length.kind != _INT32 or len(length.data) != 4 or names.kind != _INT8:
            raise _Damaged
        size = struct.unpack(f"{order}i", length.data)[0]
        if size <= 0 or len(names.data) % size:
            raise _Damaged
        fields = len(names.data) // size
    for _ in range(count * fields):
        inner = next(parts)
        if inner.kind != _MATRIX:
            raise _Damaged
        _check_array(inner.data, order, path, depth + 1)


def _unpacked(data: memoryview, left: list[int], path: Path) -> bytes:
    """A packed element; `left` bytes may still be unpacked of the whole file."""
    unpack = zlib.decompressobj()
    out = unpack.decompress(bytes(data), left[0] + 1)
    left[0] -= len(out)
    if left[0] < 0:
        raise too_large(path)
    if not unpack.eof:
        raise _Damaged
    return out
