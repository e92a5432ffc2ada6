"""Text from files and users, made safe to print."""

from __future__ import annotations

import unicodedata


def plain(text: object) -> str:
    """Return a string from outside as one printable line; control and direction characters become a box."""
    return "".join("\ufffd" if unicodedata.category(c) in _UNPRINTED else c for c in str(text))


_UNPRINTED = "Cc", "Cf", "Cn", "Co", "Cs", "Zl", "Zp"


def counted(count: int, noun: str) -> str:
    """Return ``"1 row"`` or ``"3 rows"``; the plural of the noun is with an s."""
    return f"{count} {noun}{'' if count == 1 else 's'}"
