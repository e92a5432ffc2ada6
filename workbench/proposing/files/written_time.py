"""Dates and times of day as people and programs write them, as seconds."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

_OF_DAY = re.compile(r"(\d{1,2}):(\d{2}):(\d{2}([.,]\d+)?)")
_DAY = 86400.0


def stamps(cells: Sequence[str | None]) -> np.ndarray | None:
    """Return seconds (N,) since 1970, or since midnight of the first day; None where cells are no times."""
    texts = [(cell or "").strip() for cell in cells]
    found = [_OF_DAY.fullmatch(text) for text in texts]
    if any(found) and all(f or not text for f, text in zip(found, texts, strict=True)):
        out = np.array(
            [
                int(f[1]) * 3600 + int(f[2]) * 60 + float(f[3].replace(",", ".")) if f else np.nan
                for f in found
            ]
        )
        past_midnight = np.diff(out, prepend=out[:1]) < -0.5 * _DAY
        return out + _DAY * np.cumsum(past_midnight)
    try:
        plain = [re.sub(r"(Z|[+-]00:?00)$", "", text).replace(",", ".") for text in texts]
        when = np.array(plain, dtype="datetime64[ns]")
    except ValueError:
        return None
    whole = when.astype("datetime64[D]").astype(np.int64) * _DAY
    rest = (when - when.astype("datetime64[D]")).astype(np.int64) / 1e9
    return np.where(np.isnat(when), np.nan, whole + rest)
