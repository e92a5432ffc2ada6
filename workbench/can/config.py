"""One TOML file for a robot's buses, motors, limits and loop, checked before any motion."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import ValidationError

from workbench.core import InputError
from workbench.core.files import check_format, read_toml
from workbench.core.text import did_you_mean

from .inputs import ImuTable, StopTable
from .problems import problems
from .table import Table
from .tables import (
    BenchTable,
    BusTable,
    CanConfig,
    EndpointsTable,
    LimitsTable,
    LoopTable,
    MechanismTable,
    MotorTable,
    RangesTable,
)


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
        raise _explain(error, path, table) from error
    for key, problem, remedy in problems(config):
        raise InputError(problem, file=path, column=key, remedy=remedy)
    return config


def _explain(error: ValidationError, path: Path, table: dict[str, Any]) -> InputError:
    first = error.errors()[0]
    loc: list[int | str] = list(first["loc"])
    key = ".".join(map(str, loc))
    for kind, name in (("motor", "axis"), ("bus", "name")):
        if len(loc) > 2 and loc[0] == kind:  # as people name it, not by its number
            own = table[kind][int(loc[1])].get(name, loc[1])
            key = ".".join([f"{kind} '{own}'", *map(str, loc[2:])])
    if first["type"] == "extra_forbidden":
        tables: dict[Any, type[Table]] = {
            "bus": BusTable, "motor": MotorTable, "mechanism": MechanismTable, "loop": LoopTable,
            "ranges": RangesTable, "limits": LimitsTable, "bench": BenchTable, "imu": ImuTable,
            "stop": StopTable, "endpoints": EndpointsTable,
        }  # fmt: skip
        inside = [part for part in loc[:-1] if part in tables]
        known = tuple((tables[inside[-1]] if inside else CanConfig).model_fields)
        remedy = did_you_mean(str(loc[-1]), known) or f"known keys: {', '.join(known)}"
        return InputError("unknown key", file=path, column=key, remedy=remedy)
    if first["type"] == "missing":
        return InputError("is missing", file=path, column=key, remedy="add it")
    message = first["msg"][0].lower() + first["msg"][1:]
    return InputError(
        f"{message}, found {first['input']!r}", file=path, column=key, remedy="correct the value"
    )
