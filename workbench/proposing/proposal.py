"""Parts of a proposal: assumptions with confidence, open questions, and answers of the user."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from workbench.models import Servos

#: Below this an assumption is a question.
ASK = 0.9
#: The value of what cannot be told.
UNKNOWN = "unknown"


@dataclass(frozen=True)
class Assumption:
    """One line of the table of assumptions.

    Attributes:
        what: the thing, e.g. ``unit of position``.
        value: what it is taken for.
        sure: probability that this is right; 1 where the user or the file says so.
        because: the reason, a few words.
    """

    what: str
    value: str
    sure: float
    because: str

    @property
    def word(self) -> str:
        """Return ``stated``, ``sure``, ``likely``, ``a guess``, or nothing if nothing is known."""
        if self.value == UNKNOWN:
            return ""
        if self.sure >= 1.0 and self.because == "you said so":
            return "stated"
        return "sure" if self.sure >= 0.97 else "likely" if self.sure >= ASK else "a guess"


@dataclass(frozen=True)
class Question:
    """A question that the file does not answer.

    Attributes:
        key: ``unit.KIND``, ``unit`` (its answers are ``KIND=UNIT``), ``column.SIGNAL``, ``constant`` (of the
            torque), ``rate``, ``axes``, ``coordinates``, ``counts`` or ``episode``.
        text: the question.
        choices: answers to choose from; empty where any may be right.
        best: the likeliest, ``""`` where none is.
        option: what to pass on the command line, with the likeliest answer or a placeholder in it.
    """

    key: str
    text: str
    choices: tuple[str, ...]
    best: str
    option: str


@dataclass(frozen=True)
class Answers:
    """Answers of the user; the rest is found or asked.

    Attributes:
        axes: names of the axes, in order.
        columns: signal -> the table's columns, one per axis (``time``: one).
        units: kind -> unit, or one per axis with commas between.
        coordinates: ``actuator`` or ``joint``.
        rate_hz: rows per second, where there is no time column.
        counts: encoder counts per turn.
        kp, kd, period_s: the controller, one gain per axis or one for all.
        model_axes: the model's axes, in its order.
        linear: which of the model's axes move along a line.
        transmission: the model's J in q_p = J q_s, shape (n, n), where it is not the identity.
        loop: whether the model states its loop.
        servos: position actuators of the model's file, if all its joints have one.
        floats: whether the model's base is free.
        episode: which run of a log in which time starts anew, counted from 0.
        guessed: keys of questions that were answered for the user.
        weighed: kind -> why its unit is so, where a model's weight and inertia told it.
    """

    axes: tuple[str, ...] = ()
    columns: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    coordinates: str = ""
    rate_hz: float | None = None
    counts: float | None = None
    kp: tuple[float, ...] = ()
    kd: tuple[float, ...] = ()
    period_s: float | None = None
    model_axes: tuple[str, ...] = ()
    linear: tuple[bool, ...] = ()
    transmission: np.ndarray | None = None
    loop: bool = False
    servos: Servos | None = None
    floats: bool = False
    episode: int | None = None
    guessed: frozenset[str] = frozenset()
    weighed: Mapping[str, str] = field(default_factory=dict)

    def because(self, kind: str) -> str:
        """Return the reason of a unit that was not found from the data."""
        return self.weighed.get(kind, "you said so")

    def with_guess(self, question: Question) -> Answers:
        """Return these answers and the most likely one to a question, as a guess."""
        taken = self.with_answer(question.key, question.best)
        return replace(taken, guessed=taken.guessed | {question.key})

    def with_answer(self, key: str, value: str) -> Answers:
        """Return these answers and one more; the key is that of a question.

        Raises:
            ValueError: it can be no answer to that question.
        """
        kind, _, name = key.partition(".")
        if kind == "unit":
            name, value = (name, value) if name else _pair(value)
            return replace(self, units={**self.units, name: value})
        if kind == "constant":
            constants = [f"{float(part):g}*N*m" for part in listed(value)]
            return replace(self, units={**self.units, "torque": ",".join(constants)})
        if kind == "column":
            return replace(self, columns={**self.columns, name: listed(value)})
        if kind == "coordinates":
            if value not in ("actuator", "joint"):
                raise ValueError(value)
            return replace(self, coordinates=value)
        if kind == "episode":
            if not value.isdigit():
                raise ValueError(value)
            return replace(self, episode=int(value))
        if kind == "axes":
            names = listed(value)
            if not names or (self.model_axes and sorted(names) != sorted(self.model_axes)):
                raise ValueError(value)
            return replace(self, axes=names)
        number = float(value)
        if not 0.0 < number < float("inf"):
            raise ValueError(value)
        return replace(self, rate_hz=number) if kind == "rate" else replace(self, counts=number)


@dataclass(frozen=True)
class Proposal:
    """The description of a recording, and how it was found.

    Attributes:
        description: the TOML's content; ``table`` is still missing.
        data: columns to be written as a table of their own, or None where the file serves as it is.
        assumptions: what was taken for what.
        questions: what could not be told; the description holds the likeliest answers.
        notes: what was done to the rows, what is not used, what looks wrong.
    """

    description: Mapping[str, Any]
    data: Mapping[str, np.ndarray] | None
    assumptions: tuple[Assumption, ...]
    questions: tuple[Question, ...]
    notes: tuple[str, ...]


def listed(value: str) -> tuple[str, ...]:
    """Return the comma-separated parts of a text."""
    return tuple(part.strip() for part in value.split(",") if part.strip())


def _pair(value: str) -> tuple[str, str]:
    """``KIND=UNIT`` as two.

    Raises:
        ValueError: it is no such pair.
    """
    kind, equals, unit = value.partition("=")
    if not equals:
        raise ValueError(value)
    return kind.strip(), unit.strip()
