"""Text from files and users, made safe to print."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from difflib import get_close_matches


def plain(text: object) -> str:
    """Return a string from outside as one printable line; control and direction characters become a box."""
    return "".join("\ufffd" if unicodedata.category(c) in _UNPRINTED else c for c in str(text))


_UNPRINTED = "Cc", "Cf", "Cn", "Co", "Cs", "Zl", "Zp"


def counted(count: int, noun: str) -> str:
    """Return ``"1 row"`` or ``"3 rows"``; the plural of the noun is with an s."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def did_you_mean(name: str, known: Sequence[str]) -> str:
    """Return the question for the known name that is most like one that is not; empty if none is."""
    close = get_close_matches(name, known, n=1, cutoff=0.5)
    return f"did you mean '{close[0]}'?" if close else ""
