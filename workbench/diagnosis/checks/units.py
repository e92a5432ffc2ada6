"""The unit check: units that were guessed, where another unit would explain the recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.comparison import is_weighable, torque_left
from workbench.core import Finding, InputError, Recording, SimulationError
from workbench.effects import effect_named
from workbench.inspection.factors import NAMED, name_factors
from workbench.models import Model

from ..policy import POLICY

_KINDS = {
    "position": ("position", "velocity", "position_reference", "velocity_reference", "link_position"),
    "torque": ("torque_command", "torque_measured", "torque_feedforward"),
}


def refuse_unit(model: Model, recordings: Sequence[Recording]) -> None:
    """Refuse recordings whose torque the model explains as soon as a unit that was guessed is another one.

    Raises:
        InputError: names the unit.
    """
    some = recordings[: POLICY.check_recordings]
    guessed = set.intersection(*(set(r.guessed_units) for r in some)) & _KINDS.keys()
    if not guessed or not is_weighable(model, some):
        return
    try:
        before = float(np.mean(torque_left(model, some)))
        if before <= POLICY.unit_error:
            return
        tried = {
            (kind, f): float(np.mean(torque_left(model, [_scaled(r, kind, f) for r in some])))
            for kind in sorted(guessed)
            for named, _ in NAMED
            for f in (named, 1.0 / named)
        }
    except SimulationError:
        return
    (kind, factor), left = min(tried.items(), key=lambda each: each[1])
    if left > min(POLICY.unit_error, POLICY.unit_left * before):
        return
    now = f"{100 * before:.2g} %" if before < 1.0 else "all"
    raise InputError(
        f"perhaps the unit: `import` guessed that of {kind}; {factor:.4g} times as large (as between "
        f"{' or '.join(name_factors(factor))}) the model leaves {100 * left:.2g} % of the torque "
        f"unexplained, as it stands {now}",
        file=some[0].source, column=f"units.{kind}",
        remedy="state the right unit there and take guessed_units out; if it is right, only the latter",
    )  # fmt: skip


def doubted(findings: Sequence[Finding], recordings: Sequence[Recording]) -> tuple[Finding, ...]:
    """The findings; where a factor is one between units of which one was guessed, that is said first.

    Args:
        findings: what explains the recordings.
        recordings: that were diagnosed.
    """
    guessed = sorted({kind for r in recordings for kind in r.guessed_units})
    return tuple(
        replace(f, evidence=(line, *f.evidence)) if (line := _line(f, guessed)) else f for f in findings
    )


def _scaled(recording: Recording, kind: str, factor: float) -> Recording:
    named = {name: x for name, x in recording.signals.items() if name in _KINDS[kind]}
    return recording.with_signals(**{name: factor * x for name, x in named.items()})


def _line(finding: Finding, guessed: Sequence[str]) -> str:
    factors = [p.name for p in effect_named(finding.key.effect).parameters if p.neutral == 1.0]
    for name in factors if guessed else ():
        value = finding.parameters[name].value if name in finding.parameters else 1.0
        if meanings := name_factors(value, POLICY.unit_near):
            units = " and ".join([", ".join(guessed[:-1]), guessed[-1]] if len(guessed) > 1 else guessed)
            return (
                f"perhaps the unit: {name} {value:.3g} is near the factor between {' or '.join(meanings)}, "
                f"and `import` guessed the unit of {units} (guessed_units in the recording): state it, and "
                "diagnose again"
            )
    return ""
