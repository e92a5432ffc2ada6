"""Strangers' strings, made fit to be printed."""

from __future__ import annotations

import unicodedata


def plain(text: object) -> str:
    """A stranger's string as one printable line: control and direction characters become a box."""
    return "".join("\ufffd" if unicodedata.category(c) in _UNPRINTED else c for c in str(text))


_UNPRINTED = "Cc", "Cf", "Cn", "Co", "Cs", "Zl", "Zp"
