"""The line on which a key stands in a TOML file, for messages that say which line to correct."""

from __future__ import annotations

import re

_HEADER = re.compile(r"\s*\[(?P<name>[^\[\]]+)\]\s*(?:#.*)?$")


def toml_line(text: str, table: str, key: str) -> int | None:
    """Return the line number (from 1) on which a key of a table stands.

    Args:
        text: of the file.
        table: its name, as ``"controller"``; one below the top.
        key: in it.

    Returns:
        The line of the key, or that of an inline table that holds it; None where the file has neither.
    """
    own = re.compile(rf"\s*{re.escape(key)}\s*=")
    dotted = re.compile(rf"\s*{re.escape(table)}\s*\.\s*{re.escape(key)}\s*=")
    inline = re.compile(rf"\s*{re.escape(table)}\s*=\s*\{{.*\b{re.escape(key)}\s*=")
    within = ""
    for number, line in enumerate(text.splitlines(), start=1):
        if header := _HEADER.match(line):
            within = header["name"].strip()
        elif line.lstrip().startswith("[["):
            within = "[["
        elif (within == table and own.match(line)) or (
            not within and (dotted.match(line) or inline.match(line))
        ):
            return number
    return None
