"""The sentences of a report: what a result says, for a robotics engineer, in plain words."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from workbench.core import EffectKey, Estimate, Finding, Share, Step

from .numbers import interval, number, percent, plain, short

_NAMES = {"coulomb": "Coulomb", "stribeck": "Stribeck", "lugre": "LuGre", "dahl": "Dahl", "lpf": "low-pass"}
#: Effects of a link, which turns with its joint, and not of the drive.
_OF_LINKS = ("first_moment_error", "link_inertia_error", "link_length_error")
#: Effects of the whole machine that are no property of its axes.
_WHERE = {"payload_mass": "at the end of the machine", "base_compliance": "under the machine"}
#: Effects whose one parameter is what there is: "a payload of 0.6 kg".
_THINGS = {"payload_mass": "a payload"}
#: What the error of a comparison is.
ERROR_MEANS = (
    "The error is the RMS of measured minus simulated, divided by the measured signal's standard deviation, "
    "over all axes, for position and torque."
)
_SIGNALS = {"position": "position", "torque": "torque", "torque_measured": "torque"}


def capital(text: str) -> str:
    """Return the text with its first letter in upper case."""
    return text[:1].upper() + text[1:]


def effect_name(effect: str) -> str:
    """Return ``"coulomb_friction"`` as words: ``"Coulomb friction"``; a common noun stays lower case."""
    return " ".join(_NAMES.get(word, word) for word in plain(effect).split("_"))


def place(key: EffectKey) -> str:
    """Return where an effect acts: ``"on the knee drive"``, ``"at the knee joint"``, ``"on all axes"``."""
    if key.effect in _OF_LINKS:
        return f"of the {plain(key.axis or '')} link"
    if key.site is not None:
        return f"at site '{plain(key.site)}'"
    if key.axis is None:
        if key.effect in _WHERE:
            return _WHERE[key.effect]
        return "on all axes" if key.location == "actuator" else "at all joints"
    axis = plain(key.axis)
    return f"on the {axis} drive" if key.location == "actuator" else f"at the {axis} joint"


def effect_phrase(key: EffectKey) -> str:
    """Return effect and place, e.g. ``"Coulomb friction on the knee drive"``."""
    return f"{effect_name(key.effect)} {place(key)}"


def sized_phrase(key: EffectKey, parameters: Mapping[str, Estimate]) -> str:
    """Return effect, place and one size: ``"viscous damping on the knee, 0.254 ± 0.003 N m s/rad"``."""
    if key.effect in _THINGS:
        return _thing(key, parameters)
    return f"{effect_phrase(key)}{single_value(parameters)}"


def sized_in_list(key: EffectKey, parameters: Mapping[str, Estimate]) -> str:
    """Return `sized_phrase` for a list: ``"Coulomb friction on the knee drive (0.254 ± 0.003 N m)"``."""
    if key.effect in _THINGS:
        return _thing(key, parameters).replace(" (95 %)", "")
    size = single_value(parameters).removeprefix(", ").removesuffix(" (95 %)")
    return f"{effect_phrase(key)} ({size})" if size else effect_phrase(key)


def _thing(key: EffectKey, parameters: Mapping[str, Estimate]) -> str:
    """``"a payload of 0.600 ± 0.003 kg at site 'tool'"``: the first number, the others in words."""
    if not parameters:
        return effect_phrase(key)
    size = single_value(dict(list(parameters.items())[:1])).removeprefix(", ")
    off = " (its centre is elsewhere)" if len(parameters) > 1 else ""
    return f"{_THINGS[key.effect]} of {size} {place(key)}{off}"


def any_of(phrases: Sequence[str], word: str = "or") -> str:
    """Return a list as words: ``"a, b or c"``."""
    return phrases[0] if len(phrases) == 1 else f"{', '.join(phrases[:-1])} {word} {phrases[-1]}"


def one_of_a_kind(keys: Iterable[EffectKey]) -> list[EffectKey]:
    """Return the keys; of several copies in one place only the first."""
    out: list[EffectKey] = []
    for key in keys:
        if key.copy == 1 or not any(key.same_place(k) for k in out):
            out.append(key)
    return out


def harmonics(key: EffectKey, keys: Iterable[EffectKey]) -> str:
    """Return ``" (3 harmonics)"`` if there are several copies in the place of a key; else nothing."""
    kin = [k for k in keys if k.same_place(key)]
    return f" ({len(kin)} harmonics)" if any(k.copy > 1 for k in kin) else ""


def effect_phrases(keys: Iterable[EffectKey], names: Mapping[str, str] | None = None) -> list[str]:
    """Return one phrase per effect with all its places: ``"... on the hip and knee drives"``.

    `names` stand in for those of the effects.
    """
    groups: dict[tuple[str, str, bool], list[EffectKey]] = {}
    keys = list(keys)
    for key in one_of_a_kind(keys):
        groups.setdefault((key.effect, key.location, key.axis is None), []).append(key)
    phrases = []
    for (effect, location, _), same in groups.items():
        if len(same) == 1:
            several = harmonics(same[0], keys)
            phrases.append(f"{(names or {}).get(effect) or effect_name(effect)} {place(same[0])}{several}")
            continue
        axes = any_of([plain(k.axis or "") for k in same], "and")
        where = f"on the {axes} drives" if location == "actuator" else f"at the {axes} joints"
        where = f"of the {axes} links" if effect in _OF_LINKS else where
        phrases.append(f"{(names or {}).get(effect) or effect_name(effect)} {where}")
    return phrases


def parameter_name(name: str) -> str:
    """Return ``"viscous_damping"`` as words."""
    return plain(name).replace("_", " ")


def single_value(parameters: Mapping[str, Estimate]) -> str:
    """Return ``", 0.254 ± 0.003 N m (95 %)"`` if the effect has one parameter, else nothing."""
    if len(parameters) != 1:
        return ""
    estimate = next(iter(parameters.values()))
    known = math.isfinite(estimate.std) and estimate.std > 0
    return f", {interval(estimate)}" + (" (95 %)" if known else "")


def total_phrase(finding: Finding) -> str:
    """Return ``"0.450 ± 0.002 N m, where the model has 0.150"``; empty without a corrected number."""
    if finding.total is None or not finding.model_value:
        return ""
    return f"{interval(finding.total)}, where the model has {number(finding.model_value)}"


def times_noise(error: float, noise: float) -> str:
    """Return the error divided by the noise floor: ``"12.9 times"``."""
    ratio = error / noise if noise > 0 else math.nan
    if not math.isfinite(ratio):
        return ""
    digits = 2 if ratio < 2 else 1 if ratio < 100 else 0
    return f"{ratio:.{digits}f} times"


def share_phrase(share: Share) -> str:
    """Return one share of the excess: ``"64 % is in the knee torque, at speeds of −1 to 1 rad/s"``."""
    signal = _SIGNALS.get(share.signal, plain(share.signal))
    return f"{percent(share.share)} is in the {plain(share.axis)} {signal}, {range_phrase(share)}"


def range_phrase(share: Share) -> str:
    """Return a range as words: ``"at speeds of −1 to 1 rad/s"``."""
    (low, high), unit = share.range, plain(share.unit)
    span = f"{short(low)} to {short(high)} {unit}"
    if low == -math.inf or high == math.inf:
        span = f"above {short(low)} {unit}" if high == math.inf else f"below {short(high)} {unit}"
    words = {"speed": "at speeds of", "position": "at positions of", "frequency": "at", "time": "in the time"}
    return f"{words.get(share.quantity, plain(share.quantity))} {span}"


def lookalike_sentence(keys: Sequence[EffectKey]) -> str:
    """Return what the data cannot distinguish, or nothing."""
    if not keys:
        return ""
    return f"These data cannot tell it from {any_of([effect_phrase(k) for k in keys])}."


def holdout_sentence(before: float | None, after: float | None) -> str:
    """Return the result on data that were not fitted, or that there are none."""
    if before is None or after is None:
        return "No held-out recording: nothing checks this on data that was not used for the fit."
    if not (math.isfinite(before) and math.isfinite(after)):
        return "The held-out recording could not be scored."
    verb = "falls" if after < before else "rises"
    return f"On held-out data the error {verb} from {number(before)} to {number(after)}."


def removed_sentence(step: Step) -> str:
    """Return the effects that a step made unnecessary, or nothing."""
    if not step.removed:
        return ""
    return f"This made {any_of([effect_phrase(k) for k in step.removed], 'and')} unnecessary."
