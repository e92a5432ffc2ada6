"""Values that follow from a recording alone, computed once for each."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TypeVar
from weakref import finalize

from .recording import Recording

Made = TypeVar("Made")


def once_per_recording(function: Callable[[Recording], Made]) -> Callable[[Recording], Made]:
    """Return the function with its results kept as long as their recordings are there.

    A recording never changes, and the same is asked of it in every simulation. Results are shared between
    callers, who leave arrays as they are. Two threads may both compute what neither has yet.
    """
    known: dict[int, Made] = {}

    @wraps(function)
    def once(recording: Recording) -> Made:
        which = id(recording)
        if which not in known:
            made = function(recording)
            if which not in known:
                # only then may another recording have its number
                finalize(recording, known.pop, which, None).atexit = False
            known[which] = made
        return known[which]

    return once
