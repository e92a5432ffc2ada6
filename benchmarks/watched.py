"""A number or an array that knows what it would be for other values of thresholds.

It goes through arithmetic, numpy and comparisons as the plain value does, and notes of the others:

- *flips*: a comparison, or an order or index that numpy found, would have been another;
- *escapes*: it left as another plain number into what is not watched (a slice, compiled code, a plain array);
- *shown*: it would have been written as another in a text, which decides nothing.

After its first flip the other run is another one, and nothing more is noted of it; what follows an escape is
noted as far as it is known.
"""

from __future__ import annotations

import operator
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

Key = tuple[str, float]  # a threshold, and another value of it
_LARGE = (
    1000  # numbers in an array from which it is not followed: that would be most of the work, for each value
)
_ROOT = Path(__file__).parents[1]
_CODE = tuple(str(_ROOT / part) for part in ("workbench", "benchmarks", "tests"))
_OWN = ("watched", "watching")
_FORWARD = ("neg", "pos", "abs", "invert", "lt", "le", "eq", "ne", "gt", "ge", "getitem")
_BINARY = ("add", "sub", "mul", "truediv", "floordiv", "mod", "pow", "matmul", "and", "or", "xor")


@dataclass
class Notes:
    """The thresholds read, how their comparisons came out, and where (file:line) other values acted first."""

    read: set[str] = field(default_factory=set)
    outcomes: dict[str, set[bool]] = field(default_factory=dict)
    flips: dict[Key, str] = field(default_factory=dict)
    escapes: dict[Key, str] = field(default_factory=dict)
    shown: dict[Key, str] = field(default_factory=dict)


class Watched:
    """A value, and what it would be; of the others only those that differ."""

    def __init__(self, plain: Any, others: dict[Key, Any], notes: Notes) -> None:
        self._plain, self._others, self._notes = plain, others, notes

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        function = getattr(ufunc, method)
        if method != "at" and kwargs.get("out") is None:
            return applied(function, inputs, kwargs)
        for key in _keys((inputs, kwargs)):  # written into a plain array
            _note(self._notes.escapes, key)
        return function(*_with(inputs, None), **_with(kwargs, None))

    def __array_function__(self, function: Any, types: Any, args: Any, kwargs: Any) -> Any:
        return applied(function, args, kwargs, indices_decide=True)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)

        def method(*args: Any, **kwargs: Any) -> Any:
            return applied(lambda x, *a, **k: getattr(x, name)(*a, **k), (self, *args), kwargs, True)

        here = getattr(self._plain, name)
        return method if callable(here) else applied(lambda x: getattr(x, name), (self,))

    def __iter__(self) -> Iterator[Any]:
        return (applied(operator.getitem, (self, i)) for i in range(len(self)))

    def __len__(self) -> int:
        return applied(len, (self,), indices_decide=True)

    def __round__(self, digits: int | None = None) -> Any:
        return applied(round, (self, digits), indices_decide=digits is None)

    def __array__(self, *args: Any, **kwargs: Any) -> Any:
        return np.array(self._left_as(np.asarray, self._notes.escapes), *args, **{"copy": True, **kwargs})

    def __format__(self, form: str) -> str:
        return self._left_as(lambda x: format(x, form), self._notes.shown)

    def _left_as(self, made: Callable[[Any], Any], noted: dict[Key, str]) -> Any:
        plain = made(self._plain)
        for key, value in self._others.items():
            if key not in self._notes.flips and _differ(made(value), plain):
                _note(noted, key)
        return plain


def _escape(made: Callable[[Any], Any]) -> Any:
    return lambda self: self._left_as(made, self._notes.escapes)


def _operator(function: Any, turned: bool = False) -> Any:
    return lambda self, *others: applied(function, (*others, self) if turned else (self, *others))


for _name, _made in {"float": float, "int": int, "index": operator.index, "hash": hash}.items():
    setattr(Watched, f"__{_name}__", _escape(_made))
Watched.__bool__ = _operator(bool)  # type: ignore[attr-defined]
for _name in (*_FORWARD, *_BINARY):
    _function = getattr(operator, f"__{_name}__")
    setattr(Watched, f"__{_name}__", _operator(_function))
    if _name in _BINARY:
        setattr(Watched, f"__r{_name}__", _operator(_function, turned=True))


def applied(
    function: Any, args: tuple[Any, ...], kwargs: dict[str, Any] | None = None, indices_decide: bool = False
) -> Any:
    """A function of watched values among others; `indices_decide`: a whole number that comes out decides."""
    kwargs = kwargs or {}
    plain, others = function(*_with(args, None), **_with(kwargs, None)), {}
    notes = next(_leaves((args, kwargs)))._notes
    if isinstance(plain, bool) or getattr(plain, "dtype", None) == np.bool_:
        for leaf, (name, _) in ((x, k) for x in _leaves(args) for k in x._others):
            leaf._notes.outcomes.setdefault(name, set()).update(np.unique(plain).tolist())
    for key in _keys((args, kwargs)):
        try:
            with np.errstate(all="ignore"):
                others[key] = function(*_with(args, key), **_with(kwargs, key))
        except Exception:  # the other run would have ended here, or have gone another way
            _note(notes.escapes, key)
    return watched(plain, others, notes, indices_decide)


def watched(plain: Any, others: dict[Key, Any], notes: Notes, indices_decide: bool = False) -> Any:
    """A value with what it would be; the plain one where that is nothing else, or where it decides."""
    if isinstance(plain, tuple | list) and all(len(o) == len(plain) for o in others.values()):
        parts = [{k: o[i] for k, o in others.items()} for i in range(len(plain))]
        return type(plain)([watched(p, o, notes, indices_decide) for p, o in zip(plain, parts, strict=True)])
    others = {k: v for k, v in others.items() if k not in notes.flips and _differ(v, plain)}
    if not others:
        return plain
    array = np.asarray(plain)
    whole = array.dtype.kind in "biu"
    decides = whole and array.ndim == 0 and (indices_decide or array.dtype.kind == "b")
    if not decides and array.dtype.kind in "biufc" and (whole or array.size <= _LARGE):
        return Watched(plain, others, notes)
    for key in others:
        _note(notes.flips if decides else notes.escapes, key)
    return plain


def has_watched(tree: Any) -> bool:
    """Whether a watched value is in arguments."""
    return any(True for _ in _leaves(tree))


def _differ(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return not np.array_equal(one, other, equal_nan=np.asarray(one).dtype.kind in "fc")
    return bool(one != other and (one == one or other == other))


def _with(tree: Any, key: Key | None) -> Any:
    """Arguments with the values that they would have; plain ones without a key."""
    if isinstance(tree, Watched):
        return tree._plain if key is None else tree._others.get(key, tree._plain)
    if isinstance(tree, list | tuple) and has_watched(tree):
        return type(tree)([_with(x, key) for x in tree])
    if isinstance(tree, slice):
        return slice(*_with((tree.start, tree.stop, tree.step), key))
    if isinstance(tree, dict):
        return {name: _with(x, key) for name, x in tree.items()}
    return tree


def _leaves(tree: Any) -> Iterator[Watched]:
    if isinstance(tree, Watched):
        yield tree
    elif isinstance(tree, slice):
        yield from _leaves((tree.start, tree.stop, tree.step))
    elif isinstance(tree, list | tuple | dict):
        for x in tree.values() if isinstance(tree, dict) else tree:
            yield from _leaves(x)


def _keys(tree: Any) -> dict[Key, None]:
    """The other values that lead to other arguments, but for those that have flipped."""
    return {key: None for leaf in _leaves(tree) for key in leaf._others if key not in leaf._notes.flips}


def _note(noted: dict[Key, str], key: Key) -> None:
    """The place in the project's own code, once."""
    frame = sys._getframe(1)
    while frame.f_back and (
        frame.f_globals["__name__"] in _OWN or not frame.f_code.co_filename.startswith(_CODE)
    ):
        frame = frame.f_back
    path = frame.f_code.co_filename.removeprefix(f"{_ROOT}/")
    noted.setdefault(key, f"{path.removeprefix('workbench/diagnosis/')}:{frame.f_lineno}")
