"""Sections of the page, as plain text and numbers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from workbench.core import Comparison, Diagnosis, EffectKey, Finding, Improvement, Result, Share, Step

from . import wording as w
from .answer import diagnosis_sentence, improvement_sentence, mend_sentences, near_sentence
from .comparison_words import comparison_sentence, inverse_sentence, loop_sentence
from .json import Truth
from .key_numbers import key_numbers
from .ladder import log_axis, rungs
from .numbers import interval, number, percent, plain, short
from .scores import scores
from .shapes import shape_rows
from .sheet import table_parts
from .told_apart import disagreement_lines, expected_rows, told_apart
from .trace import trace_table
from .truth import truth_rows

_RANKED = 10
_ROWS = 6


def sections(
    result: Result, before: Comparison | None, after: Comparison | None, truth: Truth | None
) -> dict[str, Any]:
    """Return everything on the page except its plots and how to reproduce it."""
    diagnosis = result.diagnosis if isinstance(result, Improvement) else result
    diagnosis = diagnosis if isinstance(diagnosis, Diagnosis) else None
    kind = "demo" if truth is not None else type(result).__name__.lower()
    return {
        "kind": kind,
        "model": plain(result.model),
        "tone": _tone(result),
        "sentence": sentence(result),
        "lines": _lines(result, before),
        "key_numbers": key_numbers(result),
        "error_means": w.ERROR_MEANS,
        "ladder": _ladder(result),
        "effects": _effects(result),
        "effects_title": _effects_title(result),
        "ranking": _ranking(diagnosis),
        "trace": table_parts(trace_table(diagnosis.trace)) if diagnosis and diagnosis.trace else None,
        "next_experiment": plain(diagnosis.next_experiment)
        if diagnosis and diagnosis.next_experiment
        else "",
        "not_excited": [w.capital(p) for p in w.effect_phrases(diagnosis.not_excited)] if diagnosis else [],
        "told_apart": _told_apart(diagnosis),
        "expected": expected_rows(diagnosis.identifiability) if diagnosis else [],
        "where": share_groups(before.where if before else ()),
        "where_after": share_groups(_left(result, after)),
        "shapes": shape_rows(diagnosis.shapes) if diagnosis else [],
        "rest": [plain(line) for line in diagnosis.evidence] if diagnosis else [],
        "scores": scores(before, after),
        "held_scores": _held_scores(result, after),
        "inverse": inverse_sentence(before, after),
        "notes": _notes(result, before),
        "truth": truth_rows(result, truth)
        if truth is not None and not isinstance(result, Comparison)
        else None,
    }


def _told_apart(diagnosis: Diagnosis | None) -> list[str]:
    if diagnosis is None:
        return []
    lines = [*disagreement_lines(diagnosis.disagreeing), *told_apart(diagnosis.identifiability)]
    return [plain(line) for line in lines]


def _held_scores(result: Result, after: Comparison | None) -> dict[str, Any]:
    held = None if isinstance(result, Comparison) else result.held_out
    return scores(held[0] if held else None, held[1] if held and after else None)


def _notes(result: Result, before: Comparison | None) -> list[str]:
    of_data = () if isinstance(result, Comparison) else result.notes
    of_comparison = (loop_sentence(before), *before.notes) if before else ()
    return [plain(n) for n in dict.fromkeys((*of_data, *of_comparison)) if n]


def sentence(result: Result) -> str:
    """Return the verdict as one sentence."""
    if isinstance(result, Comparison):
        return comparison_sentence(result)
    if isinstance(result, Diagnosis):
        return diagnosis_sentence(result)
    return improvement_sentence(result)


def _tone(result: Result) -> str:
    if isinstance(result, Comparison):
        return "consistent" if result.consistent else "missing_effect"
    return "missing_effect" if result.verdict == "partly_explained" else result.verdict


def _lines(result: Result, before: Comparison | None) -> list[str]:
    """The one to three sentences under the verdict."""
    out = []
    if isinstance(result, Comparison):
        if not result.consistent and result.where:
            out.append(f"Of the squared error above the noise, {w.share_phrase(result.where[0])}.")
        if not result.consistent:
            out.append("Run workbench diagnose on the same files to learn which effect is missing.")
        return [*out, w.ERROR_MEANS]
    if isinstance(result, Diagnosis) and result.findings:
        best = result.findings[0]
        out += [w.lookalike_sentence(best.indistinguishable_from)] if len(result.findings) == 1 else []
        out.append(w.holdout_sentence(best.holdout_error_before, result.findings[-1].holdout_error_after))
    if isinstance(result, Improvement) and result.steps:
        out.append(w.holdout_sentence(result.holdout_error_before, result.holdout_error_after))
    diagnosis = result if isinstance(result, Diagnosis) else result.diagnosis
    out += mend_sentences(diagnosis) if diagnosis else ()
    out.append(near_sentence(diagnosis))
    if before is not None and before.where and result.verdict == "unexplained":
        out.append(f"Of the squared error above the noise, {w.share_phrase(before.where[0])}.")
    return [line for line in out if line]


def _ladder(result: Result) -> dict[str, Any] | None:
    """Rows with their places along a log axis, in percent from the left."""
    steps = rungs(result)
    if len(steps) < 2:
        return None
    held_floor = None if isinstance(result, Comparison) else result.holdout_noise_error
    scale = log_axis([result.noise_error, held_floor, *(r.error for r in steps), *(r.holdout for r in steps)])

    def at(value: float | None) -> str | None:
        share = scale.place(value)
        return None if share is None else f"{100 * share:.2f}"

    rows, previous = [], None
    for r in steps:
        here = scale.place(r.error)
        fall = None if previous is None or here is None else (min(previous, here), abs(previous - here))
        rows.append(
            {
                "label": r.label,
                "error": number(r.error),
                "at": at(r.error),
                "fall": fall and tuple(f"{100 * x:.2f}" for x in fall),
                "times": w.times_noise(r.error, result.noise_error).replace(" times", " ×"),
                "holdout": number(r.holdout) if r.holdout is not None else "–",
                "holdout_at": at(r.holdout),
            }
        )
        previous = here if here is not None else previous
    return {
        "rows": rows,
        "ticks": [(at(t), number(t, 1)) for t in scale.ticks],
        "noise": number(result.noise_error),
        "noise_at": at(result.noise_error),
        "holdout": any(r.holdout is not None for r in steps),
        "held_noise": None if held_floor is None else number(held_floor),
        "held_noise_at": at(held_floor),
    }


def _effects(result: Result) -> list[dict[str, Any]]:
    if isinstance(result, Comparison):
        return []
    found: Iterable[Finding | Step] = result.findings if isinstance(result, Diagnosis) else result.steps
    findings = _findings(result)
    out = []
    for f in found:
        error = f.error_after if isinstance(f, Finding) else f.error
        total = w.total_phrase(findings[f.key]) if f.key in findings else ""
        lines = [f"Total {total}." if total else "", w.lookalike_sentence(f.indistinguishable_from)]
        if isinstance(f, Finding) and f.holdout_error_after is not None:
            lines.append(w.holdout_sentence(f.holdout_error_before, f.holdout_error_after))
        lines += [w.removed_sentence(f)] if isinstance(f, Step) else []
        out.append(
            {
                "title": w.capital(w.effect_phrase(f.key)),
                "chance": percent(findings[f.key].probability) if f.key in findings else "",
                "error": number(error),
                "parameters": [(w.parameter_name(name), interval(e)) for name, e in f.parameters.items()],
                "evidence": [plain(e) for e in f.evidence],
                "lines": [line for line in lines if line],
            }
        )
    return out


def _findings(result: Diagnosis | Improvement) -> dict[EffectKey, Finding]:
    """Findings by their effects: how probable a step is, and what it corrects, is that of its finding."""
    diagnosis = result.diagnosis if isinstance(result, Improvement) else result
    return {f.key: f for f in diagnosis.findings} if diagnosis else {}


def _effects_title(result: Result) -> str:
    if isinstance(result, Improvement):
        return (
            "What was added: the nearest effects, which are not the cause"
            if result.nearest
            else "What was added"
        )
    return "What is missing"


def _ranking(diagnosis: Diagnosis | None) -> list[dict[str, str]]:
    """The candidates that remove most of the excess, each alone."""
    if diagnosis is None:
        return []
    return [
        {
            "label": w.capital(w.effect_phrase(key)),
            "share": percent(min(share, 1.0)),
            "width": bar_width(share),
        }
        for key, share in diagnosis.ranking[:_RANKED]
    ]


def _left(result: Result, after: Comparison | None) -> tuple[Share, ...]:
    if isinstance(result, Comparison) or result.verdict == "consistent" or after is None:
        return ()
    return result.where if isinstance(result, Diagnosis) else after.where


def share_groups(shares: Iterable[Share]) -> list[dict[str, Any]]:
    """Return shares of the excess in groups, by speed, position, frequency and time; the largest first."""
    groups: dict[str, list[dict[str, str]]] = {}
    for s in sorted(shares, key=lambda s: -s.share):
        low, high = s.range
        groups.setdefault(s.quantity, []).append(
            {
                "axis": plain(s.axis),
                "signal": plain(s.signal).replace("_measured", ""),
                "range": f"{short(low)} to {short(high)} {plain(s.unit)}",
                "share": percent(s.share),
                "width": bar_width(s.share),
            }
        )
    return [{"quantity": plain(q), "rows": rows[:_ROWS]} for q, rows in groups.items()]


def bar_width(share: float) -> str:
    """Return the width of the bar of a share [%]."""
    return f"{100 * min(1.0, max(0.0, share if share == share else 0.0)):.1f}"
