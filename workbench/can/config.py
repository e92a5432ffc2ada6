"""One TOML file for a robot's buses, motors, limits and loop, checked before any motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from workbench.core import InputError
from workbench.core.files import check_format, read_toml
from workbench.core.grammar import explained

from .problems import problems
from .tables import CanConfig


def load_config(path: str | Path) -> CanConfig:
    """Return the configuration in a TOML file.

    Raises:
        InputError: a missing or malformed file, an unknown name, an identifier used twice, a limit that no
            frame can carry; the text names the key and the remedy.
    """
    path = Path(path)
    table = read_toml(path)
    check_format(table, 1, path)
    try:
        config = CanConfig.model_validate(table).model_copy(update={"source": path})
    except ValidationError as error:
        raise explained(error, CanConfig, table, path, named=_named) from error
    for key, problem, remedy in problems(config):
        raise InputError(problem, file=path, column=key, remedy=remedy)
    return config


def _named(place: Sequence[str | int], table: Mapping[str, Any]) -> str:
    """Return a key as people name it: a motor by its axis and a bus by its name, not by its number."""
    name = {"motor": "axis", "bus": "name"}.get(str(place[0]))
    if name is None or len(place) < 3:
        return ".".join(map(str, place))
    own = table[str(place[0])][place[1]].get(name, place[1])
    return ".".join([f"{place[0]} '{own}'", *map(str, place[2:])])
