"""Ways in which a valid file becomes a bad one: its bytes, its text, its tree."""

from __future__ import annotations

import copy
import json
import re
import tomllib
from collections.abc import Callable
from typing import Any
from xml.etree import ElementTree

import numpy as np
import tomli_w

Random = np.random.Generator

#: Numbers that a careless reader stumbles over.
NUMBERS = (
    float("nan"), float("inf"), -float("inf"), 0.0, -0.0, -1.0, 1e308, -1e308, 5e-324, 1e-30, 1e9, 0.5, 1e30,
)  # fmt: skip
_INTEGERS = 0, -1, 1, 2, 2**31, 2**63 - 1, -(2**63), 10**7
TEXTS = (
    "", " ", "nan", "0", "text", "../../../etc/passwd", "/etc/passwd", ".", "..", "\0", "a\nb", "x" * 5000,
    "[red]", "\x1b[31m", "<script>alert(1)</script>", "\u202e", "\U0001f916", "%s%n", "{0}", "${HOME}", "'",
)  # fmt: skip
_WORD = re.compile(rb"[A-Za-z_][\w.]*")
_NUMBER = re.compile(rb"[+-]?\d+\.?\d*(?:[eE][+-]?\d+)?")
_NUMBER_TEXTS = (
    b"nan", b"inf", b"-inf", b"0", b"-1", b"1e308", b"-1e308", b"1e999", b"5e-324", b"9" * 400, b"0x10",
    b"1_0", b"1,5", b"1.5.2", b"--1", b"", b'"7"', b"true", b"[]", b"[1.0]", b"{}", b"1e", b"\xd9\xa3",
    b"9223372036854775808",
)  # fmt: skip


def pick(random: Random, choices: Any) -> Any:
    """One of a sequence, as it is."""
    return choices[int(random.integers(len(choices)))]


def odd(random: Random, value: Any = None) -> Any:
    """A value that does not belong: another type, another size, another number."""
    kind = int(random.integers(9))
    if isinstance(value, bool) or kind == 0:
        return bool(random.integers(2))
    if isinstance(value, int | float) and kind < 6:
        scaled = float(value) * float(pick(random, (-1.0, 1e3, 1e-3, np.pi / 180, 180 / np.pi, 1e12)))
        return pick(random, (*NUMBERS, scaled, scaled, scaled))
    if isinstance(value, str) and kind < 6:
        return pick(random, (*TEXTS, value[::-1], value + "x", value[:-1], value.upper()))
    deep: Any = []
    if kind == 8:
        for _ in range(60):
            deep = [deep]
    return pick(random, (*NUMBERS, *_INTEGERS, *TEXTS, [], {}, [1.0], [[]], {"a": 1}, ["a"], deep))


def bytes_(random: Random, raw: bytes) -> bytes:
    """Bytes flipped, cut, doubled, removed, put in, or in another encoding."""
    if not raw:
        return random.bytes(int(random.integers(1, 64)))
    data, at = bytearray(raw), int(random.integers(len(raw)))
    length = int(min(len(raw) - at, 2 ** random.integers(0, 12)))
    match int(random.integers(13)):
        case 0 | 1 | 2:
            for _ in range(int(2 ** random.integers(0, 6))):
                data[int(random.integers(len(data)))] ^= 1 << int(random.integers(8))
        case 3:
            # near the start, where headers and counts are
            for _ in range(int(random.integers(1, 5))):
                data[int(random.integers(min(len(data), 256)))] = int(pick(random, (0, 1, 127, 128, 255)))
        case 4:
            del data[at:]
        case 5:
            del data[at : at + length]
        case 6:
            data[at:at] = data[at : at + length]
        case 7:
            data[at:at] = random.bytes(length)
        case 8:
            data[at : at + length] = bytes(length)
        case 9:
            data += data[: at + 1]
        case 10:
            word = pick(
                random, (b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\0\0\0\x80", b"\0" * 8, b"\xff" * 8)
            )
            data[at : at + len(word)] = word
        case 11:
            text = raw.decode("utf-8", "replace")
            return text.encode(pick(random, ("utf-16", "utf-8-sig", "utf-32", "utf-16-le")))
        case _:
            text = raw.replace(b"\n", pick(random, (b"\r\n", b"\r", b"\0\n", b"\xa0\n", b"\x85")))
            return text + pick(random, (b"", b"\0", b"\xff", b"\x1a"))
    return bytes(data)


def text(random: Random, raw: bytes) -> bytes:
    """Numbers, words and lines exchanged, removed, doubled."""
    match int(random.integers(8)):
        case 0 | 1 | 2:
            return _replaced(random, raw, _NUMBER, lambda found: pick(random, _NUMBER_TEXTS))
        case 3:
            words = sorted(set(_WORD.findall(raw))) or [b""]
            return _replaced(random, raw, _WORD, lambda found: pick(random, words))
        case 4:
            return _replaced(random, raw, _WORD, lambda found: pick(random, TEXTS).encode())
        case 5:
            lines = raw.split(b"\n")
            i, j = random.integers(len(lines), size=2)
            lines[i], lines[j] = lines[j], lines[i]
            return b"\n".join(lines)
        case 6:
            lines = raw.split(b"\n")
            del lines[int(random.integers(len(lines)))]
            return b"\n".join(lines)
        case _:
            lines = raw.split(b"\n")
            i = int(random.integers(len(lines)))
            lines[i:i] = [lines[i]] * int(2 ** random.integers(0, 8))
            return b"\n".join(lines)


def _replaced(random: Random, raw: bytes, what: re.Pattern[bytes], by: Callable[[bytes], bytes]) -> bytes:
    found = list(what.finditer(raw))
    if not found:
        return raw
    one = found[int(random.integers(len(found)))]
    return raw[: one.start()] + by(one[0]) + raw[one.end() :]


def tree(random: Random, content: Any) -> Any:
    """The same nested tables with one to three entries changed, removed, doubled, exchanged or nested."""
    content = copy.deepcopy(content)
    for _ in range(int(random.integers(1, 4))):
        places = list(_places(content))
        if not places:
            return odd(random, content)
        holder, key = pick(random, places)
        match int(random.integers(8)):
            case 0 | 1 | 2:
                holder[key] = odd(random, holder[key])
            case 3:
                del holder[key]
            case 4:
                other, there = pick(random, places)
                if there in other if isinstance(other, dict) else there < len(other):
                    holder[key], other[there] = copy.deepcopy(other[there]), copy.deepcopy(holder[key])
            case 5:
                value = holder[key]
                holder[key] = [value, copy.deepcopy(value)] if not isinstance(value, list) else value * 2
            case 6:
                if isinstance(holder, dict):
                    holder[str(pick(random, (*TEXTS, str(key) + "x", str(key).upper())))] = holder.pop(key)
                else:
                    holder.insert(key, copy.deepcopy(holder[key]))
            case _:
                if isinstance(holder, list):
                    holder.reverse()
                elif isinstance(holder[key], list) and holder[key]:
                    holder[key] = holder[key] * int(2 ** random.integers(1, 8))
    return content


def _places(content: Any) -> Any:
    entries = content.items() if isinstance(content, dict) else enumerate(content)
    for key, value in list(entries):
        yield content, key
        if isinstance(value, dict | list):
            yield from _places(value)


def toml(random: Random, raw: bytes) -> bytes:
    """A TOML file's tree, else its text."""
    try:
        return tomli_w.dumps(tree(random, tomllib.loads(raw.decode()))).encode()
    except (TypeError, ValueError, AttributeError, RecursionError):  # what TOML cannot write
        return text(random, raw)


def json_(random: Random, raw: bytes) -> bytes:
    """A JSON file's tree."""
    return json.dumps(tree(random, json.loads(raw))).encode()


def xml(random: Random, raw: bytes) -> bytes:
    """An XML file's elements and attributes."""
    root = ElementTree.fromstring(raw)
    for _ in range(int(random.integers(1, 4))):
        nodes = [(parent, child) for parent in root.iter() for child in parent]
        if not nodes:
            break
        parent, node = pick(random, nodes)
        match int(random.integers(8)):
            case 0 | 1:
                for key in (
                    list(node.attrib)[:1] if random.integers(2) else random.permutation(list(node.attrib))[:1]
                ):
                    node.set(str(key), _odd_text(random, node.attrib[str(key)]))
            case 2:
                node.text = _odd_text(random, node.text or "")
            case 3:
                parent.remove(node)
            case 4:
                parent.append(copy.deepcopy(node))
            case 5:
                _, other = pick(random, nodes)
                node.append(copy.deepcopy(other))
            case 6:
                node.tag = pick(random, sorted({n.tag for _, n in nodes}))
            case _:
                if node.attrib:
                    del node.attrib[pick(random, sorted(node.attrib))]
    return ElementTree.tostring(root)


def _odd_text(random: Random, value: str) -> str:
    parts = value.split()
    if parts and random.integers(3):
        i = int(random.integers(len(parts)))
        parts[i] = pick(random, _NUMBER_TEXTS).decode()
        return " ".join(parts)
    return re.sub(r"[\0\x1b]", "", pick(random, TEXTS))
