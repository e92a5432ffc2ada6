"""Effects to hide in virtual hardware, as options."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

from typer import Option

from workbench.core import InputError

from . import complete
from .values import parse_place, parse_values

if TYPE_CHECKING:
    from workbench.rigs import HiddenEffect, HiddenIn

HideOption = Annotated[
    str | None,
    Option(
        "--hide",
        metavar="EFFECT[@AXIS]",
        help="Hide an effect in the virtual hardware.",
        autocompletion=complete.hidden,
    ),
]
SetOption = Annotated[
    list[str] | None,
    Option("--set", metavar="name=value", help="Parameter of the hidden effect; may be given again."),
]


def hidden_in(hide: str | None, values: Sequence[str] | None) -> list[HiddenIn]:
    """The effect to hide in virtual hardware of a model, which knows its own axes, if there is one.

    Raises:
        InputError: parameters of no effect, or text that names none.
    """
    from workbench.rigs import HiddenIn

    if values and not hide:
        raise InputError(
            "--set without --hide", remedy="name the effect to hide, e.g. --hide viscous_damping@hip"
        )
    if not hide:
        return []
    key, given = parse_place(hide), parse_values(list(values or []))
    return [HiddenIn(key.effect, key.axis, key.location, {name: v.value for name, v in given.items()})]


def hidden_effects(hide: str | None, values: Sequence[str] | None) -> list[HiddenEffect]:
    """The effect to hide in the reference leg, if there is one.

    Raises:
        InputError: an unknown effect, place or parameter, or parameters of none.
    """
    from workbench.rigs import HiddenEffect

    return [HiddenEffect(**vars(each)) for each in hidden_in(hide, values)]
