"""The trace of a search: what was tried, its error, and why it was accepted or not."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from workbench.core import EffectKey, Tried

from . import wording as w
from .json_parts import key_dict, key_dicts
from .numbers import number, percent
from .sheet import SheetTable

_HEADER = ("What was tried", "Effects in the model", ">Error / noise", ">Explained", "Accepted?", "Why")


def trace_table(trace: Sequence[Tried]) -> SheetTable:
    """Return one row for each trial: what, its effects, its error, whether it was accepted and why."""
    rows = (
        (
            f"{k}. {w.capital(t.move)}" + (f", from {_named(t.begun_with)}" if t.begun_with else ""),
            _named(t.effects),
            number(t.times_noise[-1]),
            percent(t.explained),
            "yes" if t.taken else "no",
            t.why,
        )
        for k, t in enumerate(trace, 1)
    )
    return SheetTable("In the order tried", _HEADER, tuple(rows))


def trace_dicts(trace: Sequence[Tried]) -> list[dict[str, Any]]:
    """Return the JSON of a trace."""
    return [
        {
            "move": t.move,
            "begun_with": key_dicts(t.begun_with),
            "added": [
                {**key_dict(key), "rivals": [{**key_dict(k), "share": share} for k, share in rivals]}
                for key, rivals in t.added
            ],
            "effects": key_dicts(t.effects),
            "times_noise": list(t.times_noise),
            "explained": t.explained,
            "parameters": t.parameters,
            "taken": t.taken,
            "why": t.why,
        }
        for t in trace
    ]


def _named(effects: Sequence[EffectKey]) -> str:
    return w.any_of([w.effect_phrase(k) for k in effects], "and") if effects else "none"
