"""Every threshold of the diagnosis watched, while a case is diagnosed once.

A value of which neither a flip nor an escape is noted (`watched.py`) cannot change the answer, but for
numbers that are only told, as a probability. That is strict, not of first order: as long as each comparison
falls as it did, the other run does the same operations, on the numbers that are carried here. It holds for
one threshold at a time and for that value; one between may decide otherwise. It holds only where nothing is
kept from one diagnosis to the next, and none of it runs in another process.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import fields
from itertools import product
from typing import Any

import numpy as np
from watched import Notes, Watched, applied, has_watched, watched

from workbench.diagnosis.policy import Policy

_MARKS = ("exam.mark", "exam.answers", "exam.scoring", "exam.compact")  # where answers go; none is compiled


@contextmanager
def watching(values: Callable[[str], tuple[float, ...]]) -> Iterator[Notes]:
    """What each field of `POLICY` decides meanwhile; for one diagnosis at a time. Its answer is as without.

    Args:
        values: other values of a field, of the type that it has.
    """
    notes = Notes()
    others = {f.name: {(f.name, v): v for v in values(f.name)} for f in fields(Policy)}

    def get(policy: Policy, name: str) -> Any:
        plain = object.__getattribute__(policy, name)
        if name not in others:
            return plain
        notes.read.add(name)
        return watched(plain, others[name], notes)

    modules = [m for n, m in list(sys.modules.items()) if n.startswith("workbench.diagnosis") or n in _MARKS]
    Policy.__getattribute__ = get  # type: ignore[method-assign]
    for module in modules:
        module.__dict__.update(_BUILTINS)
    try:
        yield notes
    finally:
        del Policy.__getattribute__
        for module, name in product(modules, _BUILTINS):
            del module.__dict__[name]


class _FloatType(type):
    def __call__(cls, value: Any = 0.0) -> Any:
        return applied(float, (value,)) if isinstance(value, Watched) else float(value)

    def __instancecheck__(cls, value: Any) -> bool:
        return isinstance(value, float)


class _Float(metaclass=_FloatType):
    """Stands for `float`."""

    dtype = np.dtype(np.float64)  # for numpy, where it is given as a type


def _extreme(function: Any) -> Any:
    """Stands for `min` or `max`, whose comparisons alone decide nothing."""

    def of(*args: Any, **kwargs: Any) -> Any:
        args = (list(args[0]),) if len(args) == 1 else args
        if "key" not in kwargs and has_watched(args):
            return applied(function, args, kwargs)
        return function(*args, **kwargs)

    return of


def _length(of: Any) -> Any:
    """Stands for `len`, which may be no more than asked whether it is nil."""
    return applied(len, (of,)) if isinstance(of, Watched) else len(of)


#: What stands for builtins in modules of the diagnosis: those would make plain numbers of watched ones.
_BUILTINS = {"float": _Float, "min": _extreme(min), "max": _extreme(max), "len": _length}
