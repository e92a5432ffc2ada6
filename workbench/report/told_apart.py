"""Which effects the recordings can distinguish, and which recordings disagree, in words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from workbench.core import Disagreement, EffectKey, Identifiability

from . import wording as w
from .answer import in_words
from .json_parts import key_dict, key_dicts
from .numbers import short


def told_apart(known: Identifiability | None) -> list[str]:
    """Return sentences: how many effects these recordings distinguish, and which look the same."""
    if known is None:
        return []
    counts = f"{len(known.separable)} of {known.count} effects"
    lines = [
        f"These recordings can distinguish {counts} from all others, if the effect is 2 % of the "
        "drives' torque."
    ]
    places = [group for group in known.groups if _differs_in_place(group)]
    lines += [
        f"They cannot tell apart: {w.any_of([w.effect_phrase(k) for k in group], 'and')}."
        for group in known.groups
        if group not in places
    ]
    return [*lines, *_drive_or_joint(places)]


def _differs_in_place(group: Sequence[EffectKey]) -> bool:
    """Whether a group is one effect of one axis, at its drive and at its joint."""
    return len(group) > 1 and len({(key.effect, key.axis) for key in group}) == 1


def _drive_or_joint(groups: Iterable[Sequence[EffectKey]]) -> list[str]:
    """One sentence for all effects of the same axes: a drive with a gear has many of them."""
    axes_of: dict[str, list[str]] = {}
    for key, *_ in groups:
        axes_of.setdefault(key.effect, []).append(key.axis or "all axes")
    effects_of: dict[tuple[str, ...], list[str]] = {}
    for effect, axes in axes_of.items():
        effects_of.setdefault(tuple(axes), []).append(w.effect_name(effect))
    return [
        f"They cannot tell the drive from the joint of {w.any_of(axes, 'and')} as the place of "
        f"{w.any_of(effects)}."
        for axes, effects in effects_of.items()
    ]


def disagreement_lines(found: Iterable[Disagreement]) -> list[str]:
    """Return one sentence per disagreement: the effect that explains each recording, and its values."""
    lines = []
    for d in found:
        pairs = [f"{short(v)} in {name}" for name, v in zip(d.recordings, d.values, strict=True)]
        meaning = f", like the difference between {d.meaning}" if d.meaning else ""
        its = f"its {d.parameter.replace('_', ' ')} " if d.parameter else ""
        lines.append(
            f"The recordings disagree: {w.effect_phrase(d.key)} explains each of them, but {its}is "
            f"{w.any_of(pairs, 'and')}{meaning}. Look for what "
            "differed between them: a load, a gain, a unit, the day."
        )
    return lines


def expected_rows(known: Identifiability | None) -> list[dict[str, str]]:
    """Return, for each effect that shows: its parameters at a small size with the expected intervals."""
    if known is None:
        return []
    return [
        {
            "effect": w.capital(w.effect_phrase(key)),
            "values": "; ".join(in_words(parameters)),
        }
        for key, parameters in known.expected
    ]


def identifiability_dict(known: Identifiability | None) -> dict[str, Any] | None:
    """Return its JSON; None if it was not asked for."""
    if known is None:
        return None
    return {
        "separable": key_dicts(known.separable),
        "groups": [key_dicts(group) for group in known.groups],
        "not_excited": key_dicts(known.not_excited),
        "expected_std": {
            str(key): {name: e.std for name, e in parameters.items()} for key, parameters in known.expected
        },
    }


def disagreement_dicts(found: Iterable[Disagreement]) -> list[dict[str, Any]]:
    """Return the JSON of disagreements."""
    return [
        {"recordings": list(d.recordings), "effect": key_dict(d.key), "values": list(d.values)} for d in found
    ]
