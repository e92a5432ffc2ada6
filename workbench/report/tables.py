"""Results as tables for the terminal: readable at 80 columns, without colour, and in a log file."""

from __future__ import annotations

from collections.abc import Iterable

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from workbench.core import Comparison, Diagnosis, EffectKey, Finding, Improvement, Share
from workbench.core.units import torque_unit

from . import wording as w
from .answer import mend_sentences, near_sentence, rest_sentence
from .comparison_words import loop_sentence
from .json import Truth
from .ladder import rungs
from .layout import table as _table
from .layout import text as _text
from .layout import verdict as _verdict
from .numbers import interval, number, percent, plain, quantity
from .sections import sentence
from .told_apart import disagreement_lines, told_apart
from .truth import truth_rows

_SHARES = 5
#: Shares by speed, by position and by frequency are of the same error.
_OVERLAP = "Speed, position, frequency and time divide the same error differently; do not add the shares."


def compare_table(result: Comparison) -> Group:
    """Return a table: verdict, RMSE and noise of each recording and axis, and where the excess is."""
    table = _table(
        "recording",
        "axis",
        ("position", "right"),
        ("noise", "right"),
        ("torque", "right"),
        ("noise", "right"),
        ("error", "right"),
    )
    table.columns[0].max_width = 16
    table.columns[0].overflow = table.columns[1].overflow = "fold"
    for entry in result.recordings:
        for k, axis in enumerate(entry.recording.axes):
            unit = entry.recording.units[k]
            torque = torque_unit(unit)
            table.add_row(
                _text(entry.recording.name) if k == 0 else Text(),
                _text(axis),
                quantity(float(entry.position_rmse[k]), unit),
                quantity(float(entry.position_noise[k]), unit),
                quantity(float(entry.torque_rmse[k]), torque),
                quantity(float(entry.torque_noise[k]), torque),
                number(entry.error) if k == 0 else "",
            )
    spread = f" ± {number(2 * result.noise_error_std, 2)}" if result.noise_error_std > 0 else ""
    times = w.times_noise(result.error, result.noise_error)
    parts: list[RenderableType] = [
        _verdict(sentence(result), result.consistent),
        Text(
            f"error {number(result.error)}   noise floor {number(result.noise_error)}{spread}"
            + (f"   {times} the noise" if times else "")
        ),
        Text(w.ERROR_MEANS),
        table,
    ]
    if not result.consistent:
        parts += _shares("Location of the squared error above the noise", result.where)
    if result.inverse_dynamics is not None:
        inverse = 100.0 * result.inverse_dynamics.relative_error
        parts.append(
            Text(
                f"The torque that the model needs for the motion is {number(inverse)} % off the recorded one"
                f" ({result.inverse_dynamics.filter})."
            )
        )
    notes = [loop_sentence(result), *result.notes]
    parts += [_text(f"Note: {note}") for note in notes if note]
    return Group(*parts)


def diagnosis_table(result: Diagnosis) -> Group:
    """Return a table: verdict, findings with all evidence, and what to measure next."""
    good = result.verdict == "consistent"
    left = percent(result.unexplained_fraction)
    parts: list[RenderableType] = [
        _verdict(sentence(result), good),
        Text(
            f"error {number(result.error)}   noise floor {number(result.noise_error)}"
            + ("" if good else f"   unexplained {left}")
        ),
    ]
    parts += [
        _text(line) for line in (*disagreement_lines(result.disagreeing), *told_apart(result.identifiability))
    ]
    for place, finding in enumerate(result.findings, start=1):
        parts += [Text(), *_finding(place, finding, result.holdout_noise_error)]
    parts += [_text(line) for line in (near_sentence(result),) if line]
    if not good:
        parts += _shares("Location of the unexplained error", result.where)
        parts += [_text(f"  {line}") for line in result.evidence]
    parts += map(_text, mend_sentences(result))
    if result.next_experiment:
        parts += [Text(), Text.assemble(("Measure next: ", "bold"), plain(result.next_experiment))]
    if result.not_excited:
        parts += [Text(), Text.assemble(("Not excited: ", "bold"), _grouped(result.not_excited))]
    parts += [_text(f"Note: {note}") for note in result.notes]
    return Group(*parts)


def improvement_table(result: Improvement) -> Group:
    """Return a table: verdict, the error of every step, and the noise floor."""
    steps = rungs(result)
    named = bool(result.steps) and not result.nearest
    findings = {f.key: f for f in result.diagnosis.findings} if result.diagnosis else {}
    held = any(r.holdout is not None for r in steps)
    table = _table(
        "model", ("error", "right"), ("x noise", "right"), *([("held-out", "right")] if held else []), ""
    )
    for i, r in enumerate(steps):
        ratio = r.error / result.noise_error if result.noise_error > 0 else float("nan")
        row: list[RenderableType] = [_text(r.label), number(r.error), number(ratio)]
        row += [number(r.holdout)] if held else []
        table.add_row(*row, _bar(r.error, steps[0].error))
        parameters = result.steps[i - 1].parameters if i else {}
        for name, e in parameters.items():
            table.add_row(_text(f"  {w.parameter_name(name)} {interval(e)}"))
        finding = findings.get(result.steps[i - 1].key) if i else None
        if finding is not None:
            total = w.total_phrase(finding)
            if total:
                table.add_row(_text(f"  total {total}"))
            table.add_row(Text(f"  {percent(finding.probability)} probable"))
        twins = result.steps[i - 1].indistinguishable_from if i else ()
        if twins:
            table.add_row(Text(f"  or {_listed(twins)}"))
        if i and result.steps[i - 1].removed:
            table.add_row(Text(f"  {_listed(result.steps[i - 1].removed)} removed: no longer needed"))
    table.add_section()
    table.add_row(
        "Noise floor",
        number(result.noise_error),
        "1",
        *(["" if result.holdout_noise_error is None else number(result.holdout_noise_error)] if held else []),
        _bar(result.noise_error, steps[0].error),
    )
    rest = result.diagnosis.evidence if result.diagnosis and not named else ()
    return Group(
        _verdict(sentence(result), result.verdict == "consistent"),
        table,
        Text("± is half a 95 % interval."),
        *(_text(line) for line in (near_sentence(result.diagnosis), rest_sentence(result)) if line),
        *([Text("Of the model as given:")] if rest and result.nearest else []),
        *(_text(w.capital(line)) for line in rest),
        *(map(_text, mend_sentences(result.diagnosis)) if result.diagnosis else ()),
        *(_text(f"Note: {note}") for note in result.notes),
    )


def truth_table(result: Improvement | Diagnosis, truth: Truth) -> Group:
    """Return a table of hidden and found effects."""
    if not truth:
        return Group(Text("The truth", style="bold"), Text("Nothing was hidden."))
    table = _table("hidden effect", "outcome", "parameter", "true", "found (95 %)", "inside")
    for row in truth_rows(result, truth):
        if row.effect and table.row_count:
            table.add_section()
        table.add_row(
            *(_text(c) for c in (row.effect, row.outcome, row.parameter, row.true, row.found, row.inside))
        )
    return Group(Text("The truth", style="bold"), table)


def _finding(place: int, f: Finding, held_floor: float | None) -> list[RenderableType]:
    head = f"{place}. {w.capital(w.effect_phrase(f.key))}"
    rows = Table.grid(padding=(0, 2))
    rows.add_column(no_wrap=True, style="dim")
    rows.add_column(overflow="fold")
    for name, e in f.parameters.items():
        known = "  (95 %)" if e.std > 0 else ""  # a number that was not fitted has no interval
        rows.add_row(Text(w.parameter_name(name)), Text(f"{interval(e)}{known}"))
    total = w.total_phrase(f)
    if total:
        rows.add_row("total", total)
    rows.add_row("error with it", number(f.error_after))
    if f.holdout_error_before is not None and f.holdout_error_after is not None:
        fall = f"{number(f.holdout_error_before)} -> {number(f.holdout_error_after)}"
        floor = "" if held_floor is None else f"  (noise floor {number(held_floor)})"
        rows.add_row("held-out error", fall + floor)
    if f.indistinguishable_from:
        rows.add_row("looks the same", Text(_listed(f.indistinguishable_from)))
    for i, line in enumerate(f.evidence):
        rows.add_row("evidence" if i == 0 else "", _text(line))
    chance = f"  {percent(f.probability)} probable"
    return [Text.assemble((head, "bold"), chance), Padding(rows, (0, 0, 0, 3))]


def _shares(title: str, shares: Iterable[Share]) -> list[RenderableType]:
    rows = sorted(shares, key=lambda s: -s.share)[:_SHARES]
    if not rows:
        return []
    table = _table(("share", "right"), "axis", "signal", "where")
    for s in rows:
        table.add_row(
            percent(s.share), _text(s.axis), plain(s.signal).replace("_measured", ""), Text(w.range_phrase(s))
        )
    return [Text(), Text(title, style="bold"), *([Text(_OVERLAP)] if len(rows) > 1 else []), table]


def _listed(keys: Iterable[EffectKey]) -> str:
    return w.any_of([w.effect_phrase(k) for k in keys])


def _grouped(keys: Iterable[EffectKey]) -> str:
    # an "and" inside a phrase asks for semicolons between them
    return "; ".join(w.effect_phrases(keys))


def _bar(error: float, top: float) -> str:
    """A bar proportional to the error, in characters every terminal has."""
    if not (top > 0 and error == error):
        return ""
    return "#" * max(1, round(12 * min(1.0, error / top)))
