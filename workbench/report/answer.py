"""The sentences that answer: wrong numbers of a model, missing effects, what was improved, and what stays."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from workbench.core import MARGIN_TOTAL, Diagnosis, Estimate, Finding, Improvement

from .comparison_words import explained_sentence, outlier_phrase
from .numbers import interval, number, percent, plain
from .wording import (
    any_of,
    capital,
    effect_phrase,
    effect_phrases,
    harmonics,
    one_of_a_kind,
    parameter_name,
    place,
    share_phrase,
    sized_in_list,
    sized_phrase,
    times_noise,
)

_GAINS = "controller_gain_error"
_OF_GAIN = {"kp_scale": "kp is", "kd_scale": "kd is"}
_CERTAIN = 0.9  # probability of each name with which all of them are called certain
_FEW = 3  # numbers or names that are told one by one


def diagnosis_sentence(result: Diagnosis) -> str:
    """Return the result of a diagnosis as one sentence."""
    if result.verdict == "consistent":
        return explained_sentence(result.error, result.noise_error)
    if result.verdict == "unexplained" or not result.findings:
        rest = percent(result.unexplained_fraction)
        if result.by_links:
            return f"Several numbers of the links are wrong.{_by_links(result)}"
        if result.error <= MARGIN_TOTAL * result.noise_error:
            return (
                "The error as a whole is at the noise floor, but single signals are off by more than their "
                f"own noise: {_nothing(result)}."
            )
        return (
            f"Something is missing: {_nothing(result)}; {rest} of the squared error above the noise remains."
        )
    kinds: dict[Callable[[Sequence[Finding], str], str], list[Finding]] = {}
    for f in result.findings:  # what explains most comes first
        kind = _gains if f.key.effect == _GAINS else _wrong if corrects(f) else _missing
        kinds.setdefault(kind, []).append(f)
    told = [tell(some, " too" if k else "") for k, (tell, some) in enumerate(kinds.items())]
    return " ".join(told) + (
        partly_sentence(result) if result.verdict == "partly_explained" else _fall_sentence(result)
    )


def _nothing(result: Diagnosis | None) -> str:
    """That nothing can be named: a limit of the search is no fact about the machine."""
    if result is not None and result.stopped == "budget":
        return "the search ended before it had tried everything, and nothing so far explains what is missing"
    if result is not None and result.by_links:
        return "several numbers of the links are wrong, and no single one explains what is missing"
    return "no effect that was tried explains what is missing"


def _fall_sentence(result: Diagnosis) -> str:
    """What stays of the error, with a space before it, where findings explain nearly all and more than noise
    is left: a number that is far off makes all else look small.
    """
    before, after = result.held_out or (result.before, result.after)
    if before is None or after is None or after.consistent:
        return ""
    first, last = (times_noise(c.error, c.noise_error) for c in (before, after))
    return f" The error falls from {first} the noise to {last}." if first and last else ""


def partly_sentence(result: Diagnosis) -> str:
    """Return how much error stays unexplained beside what was named, with a space before it."""
    rest = percent(result.unexplained_fraction)
    sure = all(f.probability >= _CERTAIN for f in result.findings)
    this = "This is certain, but it is not" if sure else "This is not"
    links = f" Several numbers of the links are wrong too.{_by_links(result)}" if result.by_links else ""
    return f" {this} the whole cause: {rest} of the squared error above the noise has another cause.{links}"


def _by_links(result: Diagnosis) -> str:
    """How much of the torque that stays is of the links' numbers, and what to do, with a space before it."""
    share = percent(result.by_links)
    return (
        f" Other masses, centres of mass and inertias of all links together explain {share} of the torque "
        "that stays, and no single one of them does. Fit all of them with 'workbench identify links', or "
        "take them from the maker or from CAD."
    )


def improvement_sentence(result: Improvement) -> str:
    """Return the result of an improvement as one sentence."""
    fall = f"the error falls from {number(result.error_before)} to {number(result.error_after)}"
    if not result.steps:
        if result.verdict == "consistent":
            return "The model explains the data to the noise as it is; nothing was added."
        return f"Nothing was added: {_nothing(result.diagnosis)} (--nearest adds the closest effects)."
    kept, added = result.kept, result.added
    phrase = sized_phrase if len(kept) == 1 else sized_in_list
    doubts = {f.key: _or(f) for f in result.diagnosis.findings} if result.diagnosis is not None else {}
    sized = [
        phrase(s.key, s.parameters) + doubts.get(s.key, "")
        if s in added
        else f"corrected gains {place(s.key)}"
        for s in kept
    ]
    unsure = sum(bool(doubts.get(s.key)) for s in kept)
    many = f"{_count(len(kept))} effects" + (f" ({_count(unsure)} of them not sure)" if unsure else "")
    with_all = any_of(sized, "and") if len(kept) <= _FEW else many
    if result.verdict == "consistent":
        outlier = result.after.outlier if result.after is not None else None
        but = f" as a whole ({outlier_phrase(outlier)})" if outlier is not None else ""
        return f"With {with_all}, the model explains the data to the noise{but}: {fall}."
    times = times_noise(result.error_after, result.noise_error)
    rest = f", still {times} the noise floor" if times else ""
    if result.nearest:
        return f"{capital(_nothing(result.diagnosis))}. With the closest effects, {with_all}, {fall}{rest}."
    partly = result.diagnosis if result.verdict == "partly_explained" else None
    return f"With {with_all}, {fall}{rest}.{partly_sentence(partly) if partly else ''}"


def _gains(findings: Sequence[Finding], too: str) -> str:
    """That gains are not those that are stated: nothing is missing from the model."""
    told = []
    for f in findings:
        sizes = [f"{_OF_GAIN.get(name, name)} {interval(e)}" for name, e in f.parameters.items()]
        told.append(f"{place(f.key)} {any_of(sizes, 'and')} times what is stated{_or(f)}")
    return f"The controller's gains are stated wrongly{too}: {'; '.join(told)}."


def corrects(finding: Finding) -> bool:
    """Return whether a finding corrects a number of the model, instead of adding a missing effect."""
    return bool(finding.model_value if finding.model_value is not None else finding.number)


def _wrong(findings: Sequence[Finding], too: str) -> str:
    """Which numbers of the model are wrong, and what they are instead."""
    if len(findings) > _FEW:
        names = any_of(
            effect_phrases([f.key for f in findings], {f.key.effect: f.number for f in findings}), "and"
        )
        return f"{capital(_count(len(findings)))} numbers of the model are wrong{too}: {names}."
    told = any_of([_corrected(f) for f in findings], "and")
    return (
        f"{'A number' if len(findings) == 1 else 'Numbers'} of the model {_be(findings)} wrong{too}: {told}."
    )


def _corrected(finding: Finding) -> str:
    """``"the damping on the knee drive is 0.28 ± 0.02 N m s/rad, not 0.6"``."""
    what = f"the {finding.number or plain(finding.key.effect)} {place(finding.key)}"
    if finding.total is not None and finding.model_value is not None:
        return f"{what} is {interval(finding.total)}, not {number(finding.model_value)}{_or(finding)}"
    more = any_of([f"{interval(e)} {plain(name)}" for name, e in finding.parameters.items()], "and")
    return f"{what} differs by {more}{_or(finding)}"


def _or(finding: Finding) -> str:
    """That it is one name of several, or not sure, where other causes are likelier together than it."""
    alike = finding.indistinguishable_from
    # beside one effect of the whole machine, the same on each of its drives is one cause
    others = effect_phrases(alike) if finding.key.axis is None else [effect_phrase(key) for key in alike]
    if not finding.is_doubtful:
        return ""
    if not others:
        return f" (not sure: {percent(finding.probability)} probable)"
    if len(others) == 1:
        return f" (or {others[0]}, which looks the same)"
    return f" (or one of {_count(len(others))} other causes that look the same)"


def _missing(findings: Sequence[Finding], too: str) -> str:
    """Which effects are missing, with their sizes where they are few."""
    if len(findings) == 1:
        one = findings[0]
        return f"Something is missing{too}: {sized_phrase(one.key, one.parameters)}{_or(one)}."
    keys = [f.key for f in findings]
    first = [f for f in findings if f.key in one_of_a_kind(keys)]
    phrase = sized_in_list if len(first) == len(keys) <= _FEW else lambda key, _: effect_phrase(key)
    each = {f.key: f"{phrase(f.key, f.parameters)}{harmonics(f.key, keys)}{_or(f)}" for f in first}
    doubted = [key for f in first if _or(f) for key in keys if key.same_place(f.key)]
    told = effect_phrases([k for k in keys if k not in doubted]) + [each[k] for k in doubted if k in each]
    names = any_of(list(each.values()) if len(keys) <= _FEW else told, "and")
    return f"{capital(_count(len(findings)))} effects are missing{too}: {names}."


def _be(findings: Sequence[Finding]) -> str:
    return "is" if len(findings) == 1 else "are"


def _count(n: int) -> str:
    words = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")
    return words[n] if n < len(words) else str(n)


def in_words(parameters: Mapping[str, Estimate]) -> list[str]:
    """Return each parameter's name with its value and 95 % interval: ``"viscosity 0.254 ± 0.003 N m s"``."""
    return [f"{parameter_name(name)} {interval(value)}" for name, value in parameters.items()]


def mend_sentences(result: Diagnosis) -> list[str]:
    """Return which numbers of which files to correct, and that this stands in place of the effects."""
    lines = [f"{plain(capital(line))}." for line in result.mend]
    if not lines:
        return []
    once = "Correct the file or use the model with the effect, not both: the correction would count twice."
    gains = "Correct gains where they are stated; a model does not need an effect for them."
    gained = [f for f in result.findings if f.key in result.mend_recordings]
    stated = [f for f in result.findings if corrects(f) or f.key.effect == _GAINS]
    return [*lines, *([gains] if gained else ()), *([once] if len(stated) > len(gained) else ())]


def near_sentence(result: Diagnosis | None) -> str:
    """Return effects that lower the error but are not certain enough to be named; empty if there are none."""
    if result is None or not result.near:
        return ""
    near = result.near
    told = []
    for f in near:
        told.append(f"{effect_phrase(f.key)} ({', '.join(in_words(f.parameters))})")
    verb = "lowers the error and is" if len(near) == 1 else "lower the error and are"
    curve = "an arbitrary smooth curve over the same or another quantity explains as much or more"
    why = "the numbers of all links together explain more" if result.by_links else curve
    return f"{capital(any_of(told, 'and'))} {verb} not certain: {why}."


def rest_sentence(result: Improvement) -> str:
    """Return why the error stays above the noise floor, and where it is; empty if it reaches the floor."""
    if result.verdict == "consistent":
        return ""
    last = result.after if result.steps else result.before
    most = max(last.where, key=lambda s: s.share, default=None) if last is not None else None
    if not result.steps or result.nearest:  # the verdict says already that nothing explains it
        return "" if most is None else f"Of the squared error above the noise, {share_phrase(most)}."
    where = "" if most is None else f", of which {share_phrase(most)}"
    if result.diagnosis is not None and result.diagnosis.stopped == "budget":
        return f"The search ended before it had tried everything for the rest{where}."
    return f"Nothing that was tried explains the rest{where}."
