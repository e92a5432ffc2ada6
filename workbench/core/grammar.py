"""What is wrong with a file that its grammar (a pydantic model) refuses, as one line."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from .errors import InputError
from .text import did_you_mean

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError


def explained(
    error: ValidationError,
    grammar: type[BaseModel],
    content: Mapping[str, Any],
    file: str | Path | None,
    named: Callable[[Sequence[str | int], Mapping[str, Any]], str] | None = None,
) -> InputError:
    """Return the first fault of a file: its key, what was found there, and what to do.

    Args:
        error: as `grammar` raised it.
        grammar: the model of the whole file.
        content: the file, parsed.
        file: where it stands.
        named: the key of a place in `content`; its parts joined by dots if not given.
    """
    faults = [(_place(e["loc"], content, missing=e["type"] == "missing"), e) for e in error.errors()]
    # of alternatives, that which fits the farthest is meant
    own = [fault for fault in faults if fault[0][: len(faults[0][0])] == faults[0][0]]
    place, first = max(own, key=lambda fault: len(fault[0]))
    key = named(place, content) if named else ".".join(map(str, place))
    if first["type"] == "extra_forbidden":
        return unknown_key(key, str(place[-1]), _keys(grammar, place[:-1]), file)
    if first["type"] == "missing":
        return InputError("is missing", file=file, column=key, remedy="add it")
    found = first["input"]
    said = first["msg"].removeprefix("Value error, ").replace("Input should ", "must ", 1)
    said = "must be a finite number" if isinstance(found, float) and not math.isfinite(found) else said
    problem = f"{said[0].lower()}{said[1:]}, found {found!r}"
    return InputError(problem, file=file, column=key, remedy="correct the value")


def unknown_key(key: str, name: str, known: Sequence[str], file: str | Path | None) -> InputError:
    """Return the error for a key that a file may not have, with the one that may be meant."""
    remedy = did_you_mean(name, known) or f"known keys: {', '.join(known)}"
    return InputError(f"unknown key '{name}'", file=file, column=key, remedy=remedy)


def _place(loc: Sequence[str | int], content: Any, *, missing: bool) -> list[str | int]:
    """Return the keys of the file on the way to a fault, without pydantic's own names of alternatives."""
    place: list[str | int] = []
    for part in loc[: len(loc) - missing]:
        try:
            content = content[part]
        except (KeyError, IndexError, TypeError):
            continue
        place.append(part)
    return [*place, *loc[len(loc) - missing :]]


def _keys(grammar: type[BaseModel], place: Sequence[str | int]) -> tuple[str, ...]:
    """The keys of the table at this place of a file."""
    tables: list[Any] = [grammar]
    for name in (part for part in place if isinstance(part, str)):
        inner = [
            t for table in tables if name in table.model_fields for t in _tables(table.model_fields[name])
        ]
        tables = inner or tables  # the name of an entry of a dictionary is no field
    return tuple(dict.fromkeys(key for table in tables for key in table.model_fields))


def _tables(field: Any) -> list[Any]:
    """The tables inside of a field's type: of ``list[Table] | None`` it is ``Table``."""
    kind = getattr(field, "annotation", field)
    if hasattr(kind, "model_fields"):
        return [kind]
    return [table for part in get_args(kind) for table in _tables(part)]
