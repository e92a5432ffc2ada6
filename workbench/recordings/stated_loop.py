"""The loop that a recording's TOML file states."""

from __future__ import annotations

from pathlib import Path

from workbench.core import Controller, InputError
from workbench.core.text import counted

from .description import ControllerTable, Description


def stated_loop(d: Description, path: Path) -> Controller:
    """Return the stated controller; unknown if the file states none.

    Raises:
        InputError: gains that its kind needs are missing, or are not one per axis.
    """
    c = d.controller
    if c is None:
        return Controller()
    needed = {"pd": ("kp",), "cascade_pv": ("kp", "kv", "gain")}.get(c.kind, ())
    for key in needed:
        if getattr(c, key) is None:
            remedy = f"a controller of kind '{c.kind}' needs it, one number per axis"
            raise InputError("is missing", file=path, column=f"controller.{key}", remedy=remedy)
    gains = {key: _per_axis(c, key, d, path) for key in ("kp", "kd", "kv", "gain", "limit")}
    if c.kind == "pd" and not gains["kd"]:
        gains["kd"] = (0.0,) * len(d.axes)
    return Controller(
        kind=c.kind, coordinates=c.coordinates, period_s=c.period_s, velocity=c.velocity, **gains
    )


def _per_axis(c: ControllerTable, key: str, d: Description, path: Path) -> tuple[float, ...]:
    values = getattr(c, key)
    if values is None:
        return ()
    if len(values) != len(d.axes):
        raise InputError(
            f"has {counted(len(values), 'value')} for {len(d.axes)} axes", file=path,
            column=f"controller.{key}", remedy="give one number per axis",
        )  # fmt: skip
    return tuple(values)
