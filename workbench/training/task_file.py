"""A task of your own as TOML: a shipped task with other rewards, observations, commands and posture."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from workbench.core import InputError
from workbench.core.grammar import explained
from workbench.core.text import counted

from .draws import Draws
from .machine import Machine
from .randomisation import LEG_RANDOMISATION
from .situation import Array
from .task import Task
from .task_code import task_from_code
from .tasks import TASKS

TASK_FILE = "task"  # its name beside a run's model, without the suffix

_Positive = Annotated[float, Field(gt=0.0, lt=1e4, allow_inf_nan=False)]
_Number = Annotated[float, Field(allow_inf_nan=False)]


class _Seen(BaseModel):
    model_config = ConfigDict(extra="forbid")

    scale: _Number | None = None
    noise: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] | None = None
    leave_out: bool = False


class _TaskTable(BaseModel):
    """The file; what is left out is as in the base."""

    model_config = ConfigDict(extra="forbid")

    format: int
    base: str
    about: str | None = None
    episode_s: _Positive | None = None
    action_scale: _Positive | None = None
    iterations: Annotated[int, Field(ge=1)] | None = None
    hidden: list[Annotated[int, Field(ge=1, le=4096)]] | None = None
    randomisation: str | None = None
    posture: list[_Number] | None = None
    rewards: dict[str, _Number] = Field(default_factory=dict)
    observations: dict[str, _Seen] = Field(default_factory=dict)
    command_low: list[_Number] | None = None
    command_high: list[_Number] | None = None
    trunk_mass: tuple[_Number, _Number] | None = None


def load_task(file: Path) -> Task:
    """Return the task of a file: TOML that changes a shipped task, or Python with ``TASK``.

    Raises:
        InputError: it cannot be read, or names what the base has not; says which key.
    """
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot be read: {error}", file=file, remedy="give a task in TOML") from error
    return task_from_code(text, file) if file.suffix == ".py" else read_task(text, file)


def read_task(text: str, file: Path | None) -> Task:
    """Return the task of the text of such a TOML file, as in a bundle."""
    content: dict[str, Any] = {}
    try:
        content = tomllib.loads(text)
        table = _TaskTable.model_validate(content)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"is no TOML: {error}", file=file, remedy="see docs/training.md") from error
    except ValidationError as error:
        raise explained(error, _TaskTable, content, file) from error
    base = TASKS.get(_known(table.base, TASKS, "base", file))
    assert base is not None
    if table.randomisation is not None:
        _known(table.randomisation, LEG_RANDOMISATION, "randomisation", file)
    for name in table.rewards:
        _known(name, [r.name for r in base.rewards], f"rewards.{name}", file)
    for name in table.observations:
        _known(name, [o.name for o in base.observations], f"observations.{name}", file)
    changes: dict[str, Any] = {
        key: value
        for key in ("about", "episode_s", "action_scale", "iterations", "randomisation", "trunk_mass")
        if (value := getattr(table, key)) is not None
    }
    if table.trunk_mass is not None and (base.machine == "leg" or table.trunk_mass[0] > table.trunk_mass[1]):
        raise InputError(
            "is not a range of additional mass of the trunk", file=file, column="trunk_mass",
            remedy="give lowest and highest [kg] for a task of a quadruped, or leave it out",
        )  # fmt: skip
    if table.hidden is not None:
        changes["hidden"] = tuple(table.hidden)
    if table.command_low is not None or table.command_high is not None:
        changes["command"] = _between(table, file)
    weights = [replace(r, weight=table.rewards.get(r.name, r.weight)) for r in base.rewards]
    seen = [(o, table.observations.get(o.name, _Seen())) for o in base.observations]
    return replace(
        base,
        **changes,
        posture=None if table.posture is None else tuple(table.posture),
        rewards=tuple(r for r in weights if r.weight),
        observations=tuple(
            replace(
                o,
                scale=o.scale if own.scale is None else own.scale,
                noise=o.noise if own.noise is None else own.noise,
            )
            for o, own in seen
            if not own.leave_out
        ),
        source=text,
    )


def posed(task: Task, machine: Machine) -> Machine:
    """Return the machine in the posture of the task.

    Raises:
        InputError: a posture of other joints, outside the limits, or of a robot that has to stand in it.
    """
    if task.posture is None:
        return machine
    posture = np.array(task.posture)
    if machine.floating:
        raise InputError(
            "a quadruped stands in the posture of its legs", column="posture", remedy="leave it out"
        )
    if len(posture) != machine.size:
        raise InputError(
            f"{counted(len(posture), 'angle')} for {counted(machine.size, 'joint')}", column="posture",
            remedy=f"give one each: {', '.join(machine.joints)}",
        )  # fmt: skip
    outside = (posture <= machine.limits[:, 0]) | (posture >= machine.limits[:, 1])
    if outside.any():
        name = machine.joints[int(np.argmax(outside))]
        raise InputError(
            f"'{name}' is outside its limits", column="posture", remedy="give angles within them"
        )
    return replace(machine, posture=posture)


def _between(table: _TaskTable, file: Path | None) -> Any:
    low, high = table.command_low or [], table.command_high or []
    if len(low) != len(high) or not low or any(a > b for a, b in zip(low, high, strict=False)):
        raise InputError(
            "command_low and command_high need the same number of values, low to high", file=file,
            column="command_low", remedy="give both, with one pair per number of the command",
        )  # fmt: skip
    base = TASKS[table.base]
    each = base.numbers(2) - base.numbers(1)
    if each and (len(low) - base.numbers(1)) % each:
        raise InputError(
            f"a command of '{base.name}' has {each} numbers per joint, here are {len(low)}", file=file,
            column="command_low", remedy="give that many for each joint, see docs/training.md",
        )  # fmt: skip

    def command(draws: Draws, worlds: int, machine: Machine) -> Array:
        wanted = base.numbers(machine.size)
        if len(low) != wanted:
            raise InputError(
                f"{len(low)} numbers in a command of {wanted}", file=file, column="command_low",
                remedy="give one pair per number of the command",
            )  # fmt: skip
        return draws.uniform(tuple(low), tuple(high), (worlds, len(low)))

    return command


def _known(name: str, names: Any, key: str, file: Path | None) -> str:
    if name in names:
        return name
    remedy = f"choose one of {', '.join(names)}"
    raise InputError(f"'{name}' is not there", file=file, column=key, remedy=remedy)
