"""The unit check: finds guessed units where another unit would explain the recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.comparison import is_weighable, torque_left
from workbench.core import Disagreement, EffectKey, Finding, InputError, Recording, SimulationError
from workbench.effects import effect_named
from workbench.inspection.factors import NAMED, TORQUE, name_factors
from workbench.inspection.torque import driven, remark_on_torque
from workbench.models import Model
from workbench.recordings import noise_levels

from ..policy import POLICY

_GAIN = "torque_constant_error"
_KINDS = {
    "position": ("position", "velocity", "position_reference", "velocity_reference", "link_position"),
    "torque": ("torque_command", "torque_measured", "torque_feedforward"),
}

_NAMED = {"position": NAMED, "torque": TORQUE}


def differing_units(recordings: Sequence[Recording]) -> tuple[Disagreement, ...]:
    """Return recordings whose measured torque differs from its command by one factor on every axis.

    That is a unit or a torque constant that changed from one to the other; an axis by itself may be at a
    limit, or warm.
    """
    times = [_over_command(r) for r in recordings]
    known = [(r.name, x) for r, x in zip(recordings, times, strict=True) if x.size and np.isfinite(x).all()]
    if len({x.size for _, x in known}) != 1:
        return ()
    table = np.array([x for _, x in known])
    low, high = int(table.sum(axis=1).argmin()), int(table.sum(axis=1).argmax())
    apart = table[high] / table[low]
    if (apart < 1.0 + POLICY.disagreement).any() or np.ptp(apart) > POLICY.unit_near * apart.mean():
        return ()
    values = tuple(float(x) for x in np.median(table, axis=1))
    meaning = " or ".join(name_factors(values[high] / values[low], named=TORQUE))
    return (Disagreement(tuple(name for name, _ in known), EffectKey(_GAIN, None), values, meaning=meaning),)


def state_units(disagreeing: Sequence[Disagreement]) -> str | None:
    """Which unit to state in which recordings before the next experiment; None if all units are stated."""
    for found in (d for d in disagreeing if d.meaning):
        odd = [
            name
            for name, times in zip(found.recordings, found.values, strict=True)
            if abs(np.log(abs(times))) > np.log(1.0 + POLICY.disagreement)
        ]
        where = ", ".join(odd or found.recordings)
        return (
            f"Nothing yet: state the unit of the measured torque of {where} under [units] (the ratio "
            f"matches {found.meaning}), and diagnose again."
        )
    return None


def _over_command(recording: Recording) -> np.ndarray:
    """Return measured torque over command of the axes that a drive moves; NaN where the torque does not
    follow.

    Empty if either was not recorded.
    """
    command, measured = recording.get("torque_command"), recording.get("torque_measured")
    if command is None or measured is None:
        return np.zeros(0)
    times = {axis: 1.0 for axis, x in zip(recording.axes, command.T, strict=True) if np.ptp(x) > 0.0}
    for remark in remark_on_torque(driven(recording), noise_levels(recording)):
        if remark.topic in ("unit", "sign", "saturation") and remark.axis in times:
            times[remark.axis] = abs(remark.value.get("factor", np.nan))
    return np.array(list(times.values()))


def refuse_unit(model: Model, recordings: Sequence[Recording]) -> None:
    """Refuse recordings whose torque the model explains once a guessed unit is replaced by another.

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
        like = {kind: some if kind == "torque" else None for kind in guessed}
        tried = {
            (kind, f): float(np.mean(torque_left(model, [_scaled(r, kind, f) for r in some], like[kind])))
            for kind in sorted(guessed)
            for named, _ in _NAMED[kind]
            for f in (named, 1.0 / named)
        }
    except SimulationError:
        return
    (kind, factor), left = min(tried.items(), key=lambda each: each[1])
    if left > min(POLICY.unit_error, POLICY.unit_left * before):
        return
    meant = " or ".join(name_factors(factor, named=_NAMED[kind]))
    now = f"{100 * before:.2g} %" if before < 1.0 else "all"
    raise InputError(
        f"possible unit error: `import` guessed the unit of {kind}; with values {factor:.4g} times as large "
        f"(the factor between {meant}), the model leaves {100 * left:.2g} % of the torque unexplained; "
        f"as recorded, {now}",
        file=some[0].source, column=f"units.{kind}",
        remedy="state the right unit there and delete guessed_units; if the guess is right, only delete "
            "guessed_units",
    )  # fmt: skip


def doubted(findings: Sequence[Finding], recordings: Sequence[Recording]) -> tuple[Finding, ...]:
    """Return the findings, led by a doubt about the unit if a found factor is one between two units of which
    one was guessed.

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
                f"possible unit error: {name} {value:.3g} is near the factor between "
                f"{' or '.join(meanings)}, and `import` guessed the unit of {units} (guessed_units in "
                "the recording): state it, and diagnose again"
            )
    return ""
