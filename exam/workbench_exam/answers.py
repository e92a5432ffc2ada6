"""What a solver answers, as a JSON file."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .reading import read_json
from .vocabulary import EFFECTS, VERDICTS, WHOLE


@dataclass(frozen=True)
class Named:
    """One effect that is named.

    Attributes:
        effect: of the vocabulary. place: a drive, or None where it is of all drives.
        values: name -> (value, low, high), SI; low and high bound a 95 % interval, NaN where none is given.
        probability: that effect and place are right; None where the solver does not say.
        also: effects and places that the solver says the recordings cannot tell from this one.
    """

    effect: str
    place: str | None
    values: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    probability: float | None = None
    also: tuple[tuple[str, str | None], ...] = ()


@dataclass(frozen=True)
class Answer:
    """What a solver says.

    Attributes:
        verdict: of the vocabulary.
        named: effects, best first.
        outside: what else it names, in its own words; the vocabulary does not have it, and so it is false.
    """

    verdict: str
    named: tuple[Named, ...] = ()
    outside: tuple[str, ...] = ()


def to_json(answer: Answer) -> dict[str, Any]:
    """The answer form."""
    return {
        "format": 1,
        "verdict": answer.verdict,
        "named": [
            {
                "effect": each.effect,
                "place": each.place,
                "values": {
                    name: {"value": float(v[0])}
                    | ({} if math.isnan(v[1]) else {"interval": [float(v[1]), float(v[2])]})
                    for name, v in each.values.items()
                },
                "probability": None if each.probability is None else float(each.probability),
                "also": [{"effect": effect, "place": place} for effect, place in each.also],
            }
            for each in answer.named
        ],
        "outside": list(answer.outside),
    }


def from_json(data: Any, where: str = "answer", drives: Sequence[str] | None = None) -> Answer:
    """Reads and checks an answer form; with `drives` also that every place is one of these.

    Raises:
        ValueError: what is not of the form, with where it stands.
    """
    if not isinstance(data, Mapping):
        raise ValueError(f"{where}: an object with verdict, named and outside")
    if data.get("verdict") not in list(VERDICTS):  # what JSON holds may have no hash
        raise ValueError(f"{where}: verdict: one of {', '.join(VERDICTS)}")
    named = tuple(
        _named(each, f"{where}: named[{i}]", drives) for i, each in enumerate(_list(data, "named", where))
    )
    return Answer(data["verdict"], named, tuple(map(str, _list(data, "outside", where))))


def _named(each: Any, where: str, drives: Sequence[str] | None) -> Named:
    effect, place = _key(each, where, drives)
    values = each.get("values", {})
    if not isinstance(values, Mapping):
        raise ValueError(f"{where}: values: an object, name to value and interval")
    sure = each.get("probability")
    if sure is not None and not 0.0 <= _number(sure, f"{where}: probability") <= 1.0:
        raise ValueError(f"{where}: probability: from 0 to 1")
    return Named(
        effect,
        place,
        {name: _value(value, effect, name, f"{where}: values") for name, value in values.items()},
        sure,
        tuple(_key(other, f"{where}: also", drives) for other in _list(each, "also", where)),
    )


def _key(each: Any, where: str, drives: Sequence[str] | None) -> tuple[str, str | None]:
    """Effect and place, which effects of the whole machine do not have."""
    if not isinstance(each, Mapping):
        raise ValueError(f"{where}: an object with effect and place")
    effect, place = each.get("effect"), each.get("place")
    if effect not in list(EFFECTS):
        raise ValueError(f"{where}: effect: '{effect}' is not in the vocabulary")
    if effect in WHOLE:
        return effect, None
    if drives is not None and place not in drives:
        raise ValueError(f"{where}: place: '{place}' is no drive; there are {', '.join(drives)}")
    return effect, place


def _value(value: Any, effect: str, name: str, where: str) -> tuple[float, float, float]:
    if name not in EFFECTS[effect]:
        raise ValueError(f"{where}: {effect} has {', '.join(EFFECTS[effect])}, not '{name}'")
    if not isinstance(value, Mapping) or "value" not in value:
        raise ValueError(f'{where}: {name}: an object like {{"value": 0.3, "interval": [0.2, 0.4]}}')
    size = _number(value["value"], f"{where}: {name}")
    if "interval" not in value:
        return size, math.nan, math.nan
    if not isinstance(value["interval"], list | tuple) or len(value["interval"]) != 2:
        raise ValueError(f"{where}: {name}: interval: two numbers")
    low, high = (_number(bound, f"{where}: {name}: interval", bound=True) for bound in value["interval"])
    return size, low, high


def _number(value: Any, where: str, bound: bool = False) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not (bound or math.isfinite(value)):
        raise ValueError(f"{where}: a number, not {value!r}")
    return float(value)


def _list(data: Mapping[str, Any], key: str, where: str) -> Sequence[Any]:
    found = data.get(key, [])
    if not isinstance(found, list | tuple):
        raise ValueError(f"{where}: {key}: a list")
    return found


def read_answer(file: Path, drives: Sequence[str] | None = None) -> tuple[Answer, float]:
    """An answer's file, and the seconds that it took; NaN where it does not say.

    Raises:
        ValueError: as `from_json`, or it is no JSON.
    """
    data = read_json(file)
    answer = from_json(data, str(file), drives)
    clock, _ = (
        _number(data.get(key, math.nan), f"{file}: {key}", bound=True)
        for key in ("seconds", "processor_seconds")
    )
    return answer, clock
