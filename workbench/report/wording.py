"""The sentences of a report: what a result says, for a robotics engineer, in plain words."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from workbench.core import (
    HOPELESS,
    Comparison,
    Diagnosis,
    EffectKey,
    Estimate,
    Finding,
    Improvement,
    Share,
    Step,
)

from .numbers import interval, number, percent, plain, short

_NAMES = {"coulomb": "Coulomb", "stribeck": "Stribeck", "lugre": "LuGre", "dahl": "Dahl", "lpf": "low-pass"}
_SIGNALS = {"position": "position", "torque": "torque", "torque_measured": "torque"}


def capital(text: str) -> str:
    """First letter upper case, the rest as it is."""
    return text[:1].upper() + text[1:]


def effect_name(effect: str) -> str:
    """``"coulomb_friction"`` as words: ``"Coulomb friction"``; a common noun stays lower case."""
    return " ".join(_NAMES.get(word, word) for word in plain(effect).split("_"))


def place(key: EffectKey) -> str:
    """Where an effect acts: ``"on the knee drive"``, ``"at the knee joint"``, ``"on all axes"``."""
    if key.axis is None:
        return "on all axes" if key.location == "actuator" else "at all joints"
    axis = plain(key.axis)
    return f"on the {axis} drive" if key.location == "actuator" else f"at the {axis} joint"


def effect_phrase(key: EffectKey) -> str:
    """Effect and place, e.g. ``"Coulomb friction on the knee drive"``."""
    return f"{effect_name(key.effect)} {place(key)}"


def any_of(phrases: Sequence[str], word: str = "or") -> str:
    """``"a, b or c"``."""
    return phrases[0] if len(phrases) == 1 else f"{', '.join(phrases[:-1])} {word} {phrases[-1]}"


def effect_phrases(keys: Iterable[EffectKey]) -> list[str]:
    """One phrase an effect, all its places in it: ``"torque saturation on the hip and knee drives"``."""
    groups: dict[tuple[str, str, bool], list[EffectKey]] = {}
    for key in keys:
        groups.setdefault((key.effect, key.location, key.axis is None), []).append(key)
    phrases = []
    for (effect, location, _), same in groups.items():
        if len(same) == 1:
            phrases.append(effect_phrase(same[0]))
            continue
        axes = any_of([plain(k.axis or "") for k in same], "and")
        where = f"on the {axes} drives" if location == "actuator" else f"at the {axes} joints"
        phrases.append(f"{effect_name(effect)} {where}")
    return phrases


def parameter_name(name: str) -> str:
    """``"viscous_damping"`` as words."""
    return plain(name).replace("_", " ")


def single_value(parameters: Mapping[str, Estimate]) -> str:
    """``", 0.254 ± 0.003 N m (95 %)"`` where the effect has one parameter, else nothing."""
    if len(parameters) != 1:
        return ""
    estimate = next(iter(parameters.values()))
    known = math.isfinite(estimate.std) and estimate.std > 0
    return f", {interval(estimate)}" + (" (95 %)" if known else "")


def times_noise(error: float, noise: float) -> str:
    """How often the noise floor goes into the error: ``"12.9 times"``."""
    ratio = error / noise if noise > 0 else math.nan
    if not math.isfinite(ratio):
        return ""
    return (
        f"{ratio:.2f} times" if ratio < 2 else f"{ratio:.1f} times" if ratio < 100 else f"{ratio:.0f} times"
    )


def share_phrase(share: Share) -> str:
    """One share of the excess: ``"64 % is in the knee torque, at speeds of −1 to 1 rad/s"``."""
    signal = _SIGNALS.get(share.signal, plain(share.signal))
    return f"{percent(share.share)} is in the {plain(share.axis)} {signal}, {range_phrase(share)}"


def range_phrase(share: Share) -> str:
    """Where, as an adverbial: ``"at speeds of −1 to 1 rad/s"``."""
    low, high = share.range
    unit = plain(share.unit)
    span = f"{short(low)} to {short(high)} {unit}"
    if low == -math.inf or high == math.inf:
        span = f"above {short(low)} {unit}" if high == math.inf else f"below {short(high)} {unit}"
    words = {"speed": "at speeds of", "position": "at positions of", "frequency": "at", "time": "in the time"}
    return f"{words.get(share.quantity, plain(share.quantity))} {span}"


def comparison_sentence(result: Comparison) -> str:
    """What a comparison says, in one sentence."""
    if not math.isfinite(result.error):
        return "Nothing moves in these recordings, so there is nothing to compare."
    if result.consistent:
        return "The model explains the data to the noise."
    times = times_noise(result.error, result.noise_error)
    tail = f", {times} the noise floor of {number(result.noise_error)}" if times else ""
    if result.noise_error > HOPELESS:
        return (
            "The model cannot run these loops: noise alone throws it further off than all that was measured. "
            "Check the order of the axes, units, signs and gains."
        )
    if result.error <= 1.06 * result.noise_error:
        worst = _worst_signal(result)
        return f"The model does not explain the data: {worst}, though the error as a whole is at the floor."
    return f"The model does not explain the data: its error is {number(result.error)}{tail}."


def loop_sentence(result: Comparison) -> str:
    """Why no motion was compared, where that is so; else empty."""
    still = [
        e.recording
        for e in result.recordings
        if np.isnan(e.position_rmse).all()
        and not any("along the measured motion" in n for n in e.recording.notes)
    ]
    # a loop that is stated keeps its gains where it is not run, for the sake of one score
    names = [plain(r.name) for r in still if not r.controller.kp]
    if not names:
        return ""
    which = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    alike = ", in all recordings alike" if len(names) < len(still) else ""
    return (
        f"How the loop of {which} was closed is not known, so that only the torque that the motion needs is "
        f"compared{alike}. Its gains go into [controller]."
    )


def inverse_sentence(before: Comparison | None, after: Comparison | None) -> str:
    """How far the torque that the motion needs is off the recorded one; empty where it is not known."""
    if before is None or before.inverse_dynamics is None:
        return ""
    inverse = before.inverse_dynamics
    each = ", ".join(
        f"{plain(a)} {percent(float(e))}"
        for a, e in zip(before.axes, inverse.axis_relative_error, strict=False)
    )
    text = (
        f"The torque that the model needs for the measured motion differs from the torque measured by "
        f"{percent(inverse.relative_error)} ({each}; filter: {plain(inverse.filter)})."
    )
    if after is not None and after.inverse_dynamics is not None:
        text += f" With the effects added: {percent(after.inverse_dynamics.relative_error)}."
    return text


def _worst_signal(result: Comparison) -> str:
    """The signal that stands furthest above its own noise: ``"the knee position misses by 1.4 times …"``."""
    ratios = [
        (float(ratio), plain(axis), kind)
        for e in result.recordings
        for kind, rmse, noise in (
            ("position", e.position_rmse, e.position_noise),
            ("torque", e.torque_rmse, e.torque_noise),
        )
        for axis, ratio in zip(result.axes, rmse / noise, strict=True)
        if math.isfinite(ratio)
    ]
    ratio, axis, kind = max(ratios)
    return f"the {axis} {kind} misses by {short(ratio)} times its own noise"


def diagnosis_sentence(result: Diagnosis) -> str:
    """What a diagnosis says, in one sentence."""
    if result.verdict == "consistent":
        return "The model explains the data to the noise."
    if result.verdict == "unexplained" or not result.findings:
        rest = percent(result.unexplained_fraction)
        return f"Something is missing: {_nothing(result)}; {rest} of the error above the noise stays."
    if len(result.findings) == 1:
        told = f"Something is missing: {_named(result.findings[0])}."
    else:
        names = any_of([effect_phrase(f.key) for f in result.findings], "and")
        told = f"{capital(_count(len(result.findings)))} effects are missing: {names}."
    return told + (partly_sentence(result) if result.verdict == "partly_explained" else "")


def _nothing(result: Diagnosis | None) -> str:
    """That nothing can be named: a limit of the search is no fact about the machine."""
    if result is not None and result.stopped == "budget":
        return "the search ended before it had tried everything, and nothing so far explains what is missing"
    return "no effect that was tried explains what is missing"


def partly_sentence(result: Diagnosis) -> str:
    """How much stays unknown beside effects that are certain, with a space before it."""
    rest = percent(result.unexplained_fraction)
    return f" That is certain, and not all: {rest} of the error above the noise has another cause."


def improvement_sentence(result: Improvement) -> str:
    """What an improvement came to, in one sentence."""
    fall = f"the error falls from {number(result.error_before)} to {number(result.error_after)}"
    if not result.steps:
        if result.verdict == "consistent":
            return "The model explains the data to the noise as it is; nothing was added."
        return f"Nothing was added: {_nothing(result.diagnosis)} (--nearest adds what comes near)."
    added = any_of([effect_phrase(s.key) for s in result.steps], "and") if len(result.steps) < 4 else ""
    added = added or f"{_count(len(result.steps))} effects"
    if result.verdict == "consistent":
        after = result.after
        but = f" as a whole ({_worst_signal(after)})" if after is not None and not after.consistent else ""
        return f"With {added}, the model explains the data to the noise{but}: {fall}."
    times = times_noise(result.error_after, result.noise_error)
    rest = f", still {times} the noise floor" if times else ""
    if result.nearest:
        return f"{capital(_nothing(result.diagnosis))}. With what comes nearest, {added}, {fall}{rest}."
    partly = result.diagnosis if result.verdict == "partly_explained" else None
    return f"With {added}, {fall}{rest}.{partly_sentence(partly) if partly else ''}"


def lookalike_sentence(keys: Sequence[EffectKey]) -> str:
    """What the data cannot tell apart, or nothing."""
    if not keys:
        return ""
    return f"This data cannot tell it from {any_of([effect_phrase(k) for k in keys])}."


def holdout_sentence(before: float | None, after: float | None) -> str:
    """What data not used for the fit says, or that there is none."""
    if before is None or after is None:
        return "No held-out recording: nothing checks this on data that was not used for the fit."
    if not (math.isfinite(before) and math.isfinite(after)):
        return "The held-out recording could not be scored."
    verb = "falls" if after < before else "rises"
    return f"On held-out data the error {verb} from {number(before)} to {number(after)}."


def removed_sentence(step: Step) -> str:
    """What a step made needless, or nothing."""
    if not step.removed:
        return ""
    return f"This made {any_of([effect_phrase(k) for k in step.removed], 'and')} needless."


def _named(finding: Finding) -> str:
    return f"{effect_phrase(finding.key)}{single_value(finding.parameters)}"


def _count(n: int) -> str:
    words = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")
    return words[n] if n < len(words) else str(n)
