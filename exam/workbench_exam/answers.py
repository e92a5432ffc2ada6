"""What a solver answers, as a JSON file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

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
                    name: {"value": v[0]} | ({} if math.isnan(v[1]) else {"interval": [v[1], v[2]]})
                    for name, v in each.values.items()
                },
                "probability": each.probability,
                "also": [{"effect": effect, "place": place} for effect, place in each.also],
            }
            for each in answer.named
        ],
        "outside": list(answer.outside),
    }


def from_json(data: Mapping[str, Any], where: str = "answer") -> Answer:
    """Reads and checks an answer form.

    Raises:
        ValueError: what is not of the form, with where it stands.
    """
    if not isinstance(data, Mapping) or data.get("verdict") not in VERDICTS:
        raise ValueError(f"{where}: verdict: one of {', '.join(VERDICTS)}")
    named = []
    for i, each in enumerate(data.get("named", [])):
        place, effect = f"{where}: named[{i}]", each.get("effect")
        if effect not in EFFECTS:
            raise ValueError(f"{place}: effect: '{effect}' is not in the vocabulary")
        values = {}
        for name, value in each.get("values", {}).items():
            if name not in EFFECTS[effect]:
                raise ValueError(f"{place}: values: {effect} has {', '.join(EFFECTS[effect])}, not '{name}'")
            low, high = value.get("interval", (math.nan, math.nan))
            values[name] = (float(value["value"]), float(low), float(high))
        if not all(math.isfinite(v[0]) for v in values.values()):
            raise ValueError(f"{place}: values: each is a number")
        sure = each.get("probability")
        if sure is not None and not 0.0 <= sure <= 1.0:
            raise ValueError(f"{place}: probability: from 0 to 1")
        also = tuple((other["effect"], other.get("place")) for other in each.get("also", []))
        at = None if effect in WHOLE else each.get("place")
        named.append(Named(effect, at, values, sure, also))
    return Answer(data["verdict"], tuple(named), tuple(map(str, data.get("outside", []))))


def read_answer(file: Path) -> tuple[Answer, float]:
    """An answer's file, and the seconds that it took.

    Raises:
        ValueError: as `from_json`.
    """
    data = json.loads(file.read_text("utf-8"))
    return from_json(data, str(file)), float(data.get("seconds", math.nan))
