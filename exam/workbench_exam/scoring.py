"""What an answer is worth, given the truth of its case."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from .answers import Answer, Named
from .vocabulary import EFFECTS

ASKED = 1.5  # how far an effect's absence shows, over the noise, from which on it has to be named
Key = tuple[str, str | None]


def mark(
    told: Mapping[str, Any], answer: Answer, seconds: float, judged: Mapping[str, float] | None
) -> dict[str, Any]:
    """Marks of one answer, as JSON can hold them.

    Args:
        told: the truth, with the drives `one_body` (`twins.one_body`).
        answer: what is said.
        seconds: that it took.
        judged: errors on the motion that no solver saw, of `removed.judge`; None where no plant is there to
            run it.
    """
    hidden = {(h["effect"], h["place"]): h for h in told["hidden"]}
    asked = {key for key, h in hidden.items() if h["shows"] >= ASKED}
    as_true = judged is not None and judged["after"] <= 1.0
    named, left = [], dict(hidden)
    for each in sorted(answer.named, key=lambda n: (n.effect, n.place) not in hidden):
        key = _meant(each, left, as_true, told)
        how = "right" if key == (each.effect, each.place) else "alike" if key else "false"
        truth = left.pop(key, None) if key else None
        same = truth if how == "right" else None
        named.append(
            {
                "effect": each.effect,
                "place": each.place,
                "is": how,
                "probability": each.probability,
                "covered": _covered(each, same["values"]) if same else {},
            }
        )
    missed = sorted(asked & set(left), key=str)
    shows = bool(told["odd"]) or any(s["shows"] >= ASKED for s in (*told["hidden"], *told["strangers"]))
    false = sum(n["is"] == "false" for n in named) + len(answer.outside)
    wanted = _wanted(told, shows)
    return {
        "kind": told["kind"],
        "family": told["family"],
        "way": told["way"],
        "shows": shows,
        "verdict": answer.verdict,
        "wanted": wanted,
        "named": named,
        "asked": len(asked),
        "missed": [list(key) for key in missed],
        "false": false,
        "names_right": not missed and not false,
        "good": not missed and not false and answer.verdict in wanted,
        "outside": list(answer.outside),
        "abstained": not answer.named and not answer.outside,
        "removed": _removed(judged),
        "seconds": seconds,
    }


def _meant(each: Named, left: Mapping[Key, Any], as_true: bool, told: Mapping[str, Any]) -> Key | None:
    """Which hidden effect a name stands for: itself, one body seen twice, or one that moves just as it."""
    if (each.effect, each.place) in left:
        return each.effect, each.place
    twins = {"link_inertia_error": "reflected_inertia", "reflected_inertia": "link_inertia_error"}
    key = (twins.get(each.effect, ""), each.place)
    if key in left and each.place in told["one_body"]:  # there a link and its rotor turn as one
        return key
    return next((other for other in each.also if other in left), None) if as_true else None


def _wanted(told: Mapping[str, Any], shows: bool) -> list[str]:
    """Verdicts that are true of a case."""
    own = {
        "clean": "consistent",
        "stranger": "unexplained",
        "beside": "partly_explained",
        "disagree": "recordings_disagree",
    }
    return [own.get(told["kind"], "missing_effect")] + ["consistent"] * (not shows)


def _covered(each: Named, truth: Mapping[str, float]) -> dict[str, bool]:
    """Which intervals hold the truth; an angle's modulo a turn."""
    held = {}
    for name, (_, low, high) in each.values.items():
        if name in truth and low < high and EFFECTS[each.effect][name]:
            turn = (
                round((0.5 * (low + high) - truth[name]) / (2 * math.pi)) * 2 * math.pi
                if name == "phase"
                else 0.0
            )
            held[name] = low <= truth[name] + turn <= high
    return held


def _removed(judged: Mapping[str, float] | None) -> float | None:
    """Share of the error that can be removed which is, from -1 to 1; None where nothing can be."""
    if judged is None or judged["before"] < judged["floor"] + 1.0:
        return None
    share = (judged["before"] - judged["after"]) / (judged["before"] - judged["floor"])
    return min(1.0, max(-1.0, share)) if math.isfinite(share) else -1.0


def wilson(good: int, of: int) -> tuple[float, float]:
    """95 % interval of a share (E. B. Wilson, J. Am. Stat. Assoc. 22, 1927)."""
    if not of:
        return 0.0, 1.0
    z, share = 1.959964, good / of
    centre, scale = share + z * z / (2 * of), 1 + z * z / of
    half = z * math.sqrt(share * (1 - share) / of + z * z / (4 * of * of))
    return max(0.0, (centre - half) / scale), min(1.0, (centre + half) / scale)
