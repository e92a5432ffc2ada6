"""Thresholds that know what they would have decided with another value, while a case is diagnosed once.

Every field of `POLICY` is read as a number that carries itself and its other values through arithmetic, numpy and
comparisons. The diagnosis goes the way of the plain value, and its answer is what it is without watching. Noted are

- *flips*: a comparison, or an order or index that numpy found, would have been another with another value;
- *escapes*: another value left as a plain number into what cannot be watched (a slice, a count, compiled code);
- *shown*: another value would have been written in a text or in marks, and decides nothing there.

A value without a flip and without an escape cannot change the answer but for numbers that are shown. That is strict,
not of first order: as long as each comparison falls as it did, the other run does the same operations, on numbers
that are carried here exactly as it would have them. It holds for one field at a time, and for one value: what lies
between may differ. After a first flip the other run is another one, and nothing more is noted of it; what follows
an escape is noted as far as it is known.
"""

from __future__ import annotations

import operator
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, fields
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from workbench.diagnosis.policy import Policy

Key = tuple[str, float]  # a field, and another value of it
_ROOT = Path(__file__).parents[1]
_OWN = tuple(str(_ROOT / part) for part in ("workbench", "benchmarks", "tests"))
_WATCHED = ("workbench.diagnosis", "exam.")  # modules whose builtins know watched numbers
_LARGE = 1000  # numbers in an array, from which it is not followed: most of the work would be done for each value
_UNARY = ("neg", "pos", "abs", "invert")
_COMPARISONS = ("lt", "le", "eq", "ne", "gt", "ge")
_BINARY = ("add", "sub", "mul", "truediv", "floordiv", "mod", "pow", "matmul", "and", "or", "xor")


@dataclass
class Notes:
    """What a watched diagnosis did with thresholds: the fields read, and the place (file:line) of each first event."""

    read: set[str] = field(default_factory=set)
    flips: dict[Key, str] = field(default_factory=dict)
    escapes: dict[Key, str] = field(default_factory=dict)
    shown: dict[Key, str] = field(default_factory=dict)


@contextmanager
def watching(values: Callable[[str], tuple[float, ...]]) -> Iterator[Notes]:
    """What each field decides meanwhile; for one diagnosis at a time.

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
        return _made(plain, others[name], notes)

    modules = [m for n, m in list(sys.modules.items()) if n.startswith(_WATCHED)]
    Policy.__getattribute__ = get  # type: ignore[method-assign]
    for module in modules:
        module.__dict__.update(_BUILTINS)
    try:
        yield notes
    finally:
        del Policy.__getattribute__
        for module, name in product(modules, _BUILTINS):
            del module.__dict__[name]


class Watched:
    """A number or an array with what it would be for other values of thresholds."""

    def __init__(self, plain: Any, others: dict[Key, Any], notes: Notes) -> None:
        self._plain, self._others, self._notes = plain, others, notes

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        function = getattr(ufunc, method)
        if method != "at" and kwargs.get("out") is None:
            return _applied(function, inputs, kwargs)
        for key in _keys((inputs, kwargs)):
            _note(self._notes.escapes, key)  # it is written into a plain array
        return function(*_with((inputs), None), **_with(kwargs, None))

    def __array_function__(self, function: Any, types: Any, args: Any, kwargs: Any) -> Any:
        return _applied(function, args, kwargs, indices_decide=True)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if not callable(getattr(self._plain, name)):
            return _applied(lambda x: getattr(x, name), (self,), {})
        return lambda *a, **k: _applied(
            lambda x, *a, **k: getattr(x, name)(*a, **k), (self, *a), k, indices_decide=True
        )

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __len__(self) -> int:
        return _applied(len, (self,), {}, indices_decide=True)

    def __getitem__(self, index: Any) -> Any:
        return _applied(operator.getitem, (self, index), {})

    def __round__(self, digits: int | None = None) -> Any:
        return _applied(round, (self, digits), {}, indices_decide=digits is None)

    def __bool__(self) -> bool:
        return _applied(bool, (self,), {})

    def __array__(self, *args: Any, **kwargs: Any) -> Any:
        return np.array(self._left_as(np.asarray, self._notes.escapes), *args, **{"copy": True, **kwargs})

    def __float__(self) -> float:
        return self._left_as(float, self._notes.escapes)

    def __int__(self) -> int:
        return self._left_as(int, self._notes.escapes)

    def __index__(self) -> int:
        return self._left_as(operator.index, self._notes.escapes)

    def __hash__(self) -> int:
        return self._left_as(hash, self._notes.escapes)

    def __format__(self, form: str) -> str:
        return self._left_as(lambda x: format(x, form), self._notes.shown)

    def __repr__(self) -> str:
        return self._left_as(repr, self._notes.shown)

    def _left_as(self, made: Callable[[Any], Any], noted: dict[Key, str]) -> Any:
        plain = made(self._plain)
        for key, value in self._others.items():
            if _differ(made(value), plain):
                _note(noted, key)
        return plain


def _operator(function: Any, turned: bool = False) -> Any:
    def method(self: Watched, *others: Any) -> Any:
        return _applied(function, (*others, self) if turned else (self, *others), {})

    return method


for _name in (*_UNARY, *_COMPARISONS, *_BINARY):
    _function = getattr(operator, f"__{_name}__")
    setattr(Watched, f"__{_name}__", _operator(_function))
    if _name in _BINARY:
        setattr(Watched, f"__r{_name}__", _operator(_function, turned=True))


class _FloatType(type):
    def __call__(cls, value: Any = 0.0) -> Any:
        return _applied(float, (value,), {}) if isinstance(value, Watched) else float(value)

    def __instancecheck__(cls, value: Any) -> bool:
        return isinstance(value, float)


class _Float(metaclass=_FloatType):
    """Stands for `float` in modules of the diagnosis: it leaves watched numbers watched."""

    dtype = np.dtype(np.float64)  # for numpy, where it is given as a type


def _extreme(function: Any) -> Any:
    def of(*args: Any, **kwargs: Any) -> Any:
        args = (list(args[0]),) if len(args) == 1 else args
        watched = "key" not in kwargs and any(True for _ in _leaves(args))
        return _applied(function, args, kwargs) if watched else function(*args, **kwargs)

    return of


# what would make a plain number of a watched one, or decide where it need not
_BUILTINS = {"float": _Float, "min": _extreme(min), "max": _extreme(max)}


def _applied(function: Any, args: tuple[Any, ...], kwargs: dict[str, Any], indices_decide: bool = False) -> Any:
    """A function of the plain values, and of the others."""
    keys, notes = _keys((args, kwargs)), _notes_of((args, kwargs))
    plain, others = function(*_with(args, None), **_with(kwargs, None)), {}
    for key in keys:
        try:
            with np.errstate(all="ignore"):
                others[key] = function(*_with(args, key), **_with(kwargs, key))
        except Exception:  # the other run would have ended here or gone another way
            _note(notes.escapes, key)
    return _made(plain, others, notes, indices_decide)


def _made(plain: Any, others: dict[Key, Any], notes: Notes, indices_decide: bool = False) -> Any:
    """A result with what it would be; plain where that decides, or is no other."""
    if isinstance(plain, tuple | list) and all(len(o) == len(plain) for o in others.values()):
        parts = [{k: o[i] for k, o in others.items()} for i in range(len(plain))]
        return type(plain)([_made(p, o, notes, indices_decide) for p, o in zip(plain, parts, strict=True)])
    others = {k: v for k, v in others.items() if k not in notes.flips and _differ(v, plain)}
    if not others:
        return plain
    array = np.asarray(plain)
    whole, alone = array.dtype.kind in "biu", array.ndim == 0
    decides = whole and alone and (indices_decide or array.dtype.kind == "b")
    if not decides and array.dtype.kind in "biufc" and (whole or array.size <= _LARGE):
        return Watched(plain, others, notes)
    for key in others:
        _note(notes.flips if decides else notes.escapes, key)
    return plain


def _differ(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return not np.array_equal(one, other, equal_nan=np.asarray(one).dtype.kind in "fc")
    return bool(one != other and (one == one or other == other))


def _with(tree: Any, key: Key | None) -> Any:
    """Arguments with the values that they would have; plain ones without a key."""
    if isinstance(tree, Watched):
        return tree._plain if key is None else tree._others.get(key, tree._plain)
    if isinstance(tree, list | tuple) and any(True for _ in _leaves(tree)):
        return type(tree)([_with(x, key) for x in tree])
    if isinstance(tree, slice):
        return slice(*_with((tree.start, tree.stop, tree.step), key))
    if isinstance(tree, dict):
        return {name: _with(x, key) for name, x in tree.items()}
    return tree


def _leaves(tree: Any) -> Iterator[Watched]:
    if isinstance(tree, Watched):
        yield tree
    elif isinstance(tree, list | tuple):
        for x in tree:
            yield from _leaves(x)
    elif isinstance(tree, slice):
        yield from _leaves((tree.start, tree.stop, tree.step))
    elif isinstance(tree, dict):
        yield from _leaves(list(tree.values()))


def _keys(tree: Any) -> list[Key]:
    return list({key: None for leaf in _leaves(tree) for key in leaf._others if key not in leaf._notes.flips})


def _notes_of(tree: Any) -> Notes:
    return next(_leaves(tree))._notes


def _note(noted: dict[Key, str], key: Key) -> None:
    """The place in the project's own code, once."""
    if key in noted:
        return
    frame = sys._getframe(1)
    while frame.f_back and (frame.f_code.co_filename == __file__ or not frame.f_code.co_filename.startswith(_OWN)):
        frame = frame.f_back
    path = frame.f_code.co_filename.removeprefix(f"{_ROOT}/").removeprefix("workbench/diagnosis/")
    noted[key] = f"{path}:{frame.f_lineno}"
