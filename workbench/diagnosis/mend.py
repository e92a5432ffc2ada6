"""Which number in which file is wrong: the line to correct, instead of an effect to add."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from workbench.core import (
    Controller,
    Diagnosis,
    EffectKey,
    Estimate,
    Finding,
    InputError,
    Recording,
    Recordings,
)
from workbench.core.toml_line import toml_line
from workbench.effects import Change, into_file
from workbench.models import AppliedEffect, Model

from .policy import POLICY
from .significance import INTERVAL

_GAINS = "controller_gain_error"
#: Of which list of [actuators] an effect at a drive corrects the entry, and its parameter.
_ACTUATORS = {"viscous_damping": ("damping", "damping"), "reflected_inertia": ("inertia", "inertia")}
_MOST = 3  # files of recordings that are listed one by one
_XML = (".xml", ".urdf")


def mend_lines(model: Model, recordings: Sequence[Recording], findings: Sequence[Finding]) -> tuple[str, ...]:
    """Return corrections (file, line, number) where findings show that a stated number is wrong.

    Args:
        model: as given, with the files that it was read from.
        recordings: those that the findings are about.
        findings: of a diagnosis.

    Returns:
        One sentence per number, with its probability where one more experiment is advised; none for effects
        that are missing, where another cause is likelier, or where the file cannot be told.
    """
    lines = list[str]()
    for finding in (f for f in findings if not f.is_doubtful):
        sure = (
            ""
            if finding.probability >= POLICY.doubtful
            else f" ({100.0 * finding.probability:.0f} % probable)"
        )
        if finding.key.effect == _GAINS:
            lines += (line + sure for line in _gains(model, recordings, finding))
        elif finding.number and finding.model_value != 0.0:
            lines += (line + sure for line in _of_model(model, finding))
    return tuple(dict.fromkeys(lines))


def mend_recordings(
    model: Model, recordings: Sequence[Recording], findings: Sequence[Finding]
) -> tuple[EffectKey, ...]:
    """Return the findings that are wrong gains of recordings and are corrected there (`mend_lines`)."""
    stating = [r for r in recordings if _states_gains(r)]
    return tuple(
        f.key
        for f in findings
        if f.key.effect == _GAINS and stating and mend_lines(model, stating, [f])
    )  # fmt: skip


def states_gain(recordings: Sequence[Recording], key: EffectKey) -> bool:
    """Return whether an effect is a wrong gain that files of recordings state: it is corrected there, and the
    model does not need it.
    """
    return key.effect == _GAINS and any(map(_states_gains, recordings))


def with_mended_gains(recordings: Sequence[Recording], diagnosis: Diagnosis) -> Recordings:
    """Return recordings with the gains that a diagnosis says to write in their files.

    Args:
        recordings: of the machine that was diagnosed, used for it or not; with all axes of the model.
        diagnosis: whose `mend_recordings` are taken.
    """
    out = list(recordings)
    for finding in (f for f in diagnosis.findings if f.key in diagnosis.mend_recordings):
        for i, (recording, c) in enumerate((r, r.controller) for r in out):
            if _states_gains(recording) and finding.key.axis in recording.axes:
                axis = recording.axes.index(finding.key.axis)
                gains = {
                    name: _scaled(getattr(c, name), axis, finding.parameters[scale].value)
                    for name, scale in _scales(c)
                    if scale in finding.parameters
                }
                out[i] = replace(recording, controller=replace(c, **gains))
    return Recordings(out)


def _states_gains(recording: Recording) -> bool:
    return recording.controller.kind != "unknown" and recording.source is not None


def _scales(controller: Controller) -> tuple[tuple[str, str], ...]:
    """Return the gains of a loop that may be wrong, each with the parameter of the effect that scales it."""
    return ("kp", "kp_scale"), ("kv" if controller.kind == "cascade_pv" else "kd", "kd_scale")


def _scaled(gains: tuple[float, ...], axis: int, scale: float) -> tuple[float, ...]:
    return tuple(gain * scale if k == axis else gain for k, gain in enumerate(gains))


def _gains(model: Model, recordings: Sequence[Recording], finding: Finding) -> Iterator[str]:
    """Return corrections of the gains in the recordings that state them, otherwise in the model."""
    if finding.key.axis not in model.axes:
        return
    stating = {r.source: r.controller for r in recordings if _states_gains(r) and r.source}
    if not stating and model.source:
        stating = {model.source: model.controller}
    axis = finding.key.axis, model.axes.index(finding.key.axis)
    for source, controller in list(stating.items())[:_MOST]:
        for name, scale in _scales(controller):
            line = _gain(Path(source), controller, name, axis, finding.parameters.get(scale))
            if line:
                yield line
    if len(stating) > _MOST:
        yield f"{len(stating) - _MOST} more recordings state the same gains"


def _gain(
    file: Path, controller: Controller, name: str, axis: tuple[str, int], scale: Estimate | None
) -> str:
    """Return the correction of one gain in one file, if the gain is certainly wrong."""
    (called, index), values = axis, getattr(controller, name)
    if scale is None or index >= len(values):
        return ""
    off = abs(scale.value - 1.0)
    if off < max(POLICY.model_deviation, INTERVAL * (scale.std if np.isfinite(scale.std) else 0.0)):
        return ""
    old = values[index]
    where, new = _where(file, "controller", name), scale.value * old
    return f"correct {where}: {name} of {called} is {old:.4g} and should be {new:.4g}"


def _where(file: Path, table: str, key: str) -> str:
    """The file, line and key of a TOML number; without the line if the file has changed since loading."""
    try:
        line = toml_line(file.read_text(encoding="utf-8-sig"), table, key)
    except (OSError, UnicodeDecodeError):
        line = None
    at = f", line {line}" if line else ""
    return f"{_shown(file)}{at} ([{table}])"


def _shown(file: Path) -> str:
    """Return a path as the user knows it: relative to the working directory if it lies below it."""
    whole, here = file.resolve(), Path.cwd()
    return str(whole.relative_to(here) if whole.is_relative_to(here) else file)


def _of_model(model: Model, finding: Finding) -> Iterator[str]:
    """The correction of a number of the model, in its TOML if stated there, otherwise in its MJCF or URDF."""
    key, applied = finding.key, AppliedEffect(finding.key, finding.parameters)
    name, parameter = _ACTUATORS.get(key.effect, ("", ""))
    in_toml = model.source is not None and model.source.suffix == ".toml"
    if name and in_toml and key.location == "actuator" and key.axis in model.axes:
        assert model.source is not None
        old = getattr(model.actuators, name)[model.axes.index(key.axis)]
        new = old + finding.parameters[parameter].value
        if old and new >= 0.0:
            yield (
                f"correct {_where(model.source, 'actuators', name)}: {name} of {key.axis} is {old:.4g} "
                f"and should be {new:.4g}"
            )
            return
    for file in (f for f in model.files if f.suffix.lower() in _XML):
        try:
            made = into_file(replace(model, effects=(applied,)), file)
            old_lines = file.read_bytes().splitlines()
        except (InputError, OSError):
            continue  # it stands in another file, or in none
        if made.written and made.changes:
            where = _changed(old_lines, made.content.splitlines())
            yield f"correct {_shown(file)}{where}: {'; '.join(map(_change, made.changes))}"
            return


def _changed(old: Sequence[bytes], new: Sequence[bytes]) -> str:
    """Return ``", line 12"``: the lines of a file that change, or after which text is inserted."""
    blocks = difflib.SequenceMatcher(None, old, new, autojunk=False).get_opcodes()
    lines = [k + (tag != "insert") for tag, k, _, _, _ in blocks if tag != "equal"]
    if not lines:
        return ""
    return f", line{'s' * (len(lines) > 1)} {', '.join(map(str, lines))}"


def _change(change: Change) -> str:
    where = (
        f"the body of {change.joint}" if np.ndim(change.before) or change.number == "mass" else change.joint
    )
    return f"{change.number} of {where} is {_short(change.before)} and should be {_short(change.after)}"


def _short(value: float | np.ndarray) -> str:
    """Return numbers to four digits of the largest; of a tensor, its three diagonal entries."""
    numbers = np.diag(value) if np.ndim(value) == 2 else np.atleast_1d(value)
    largest = float(np.abs(numbers).max())
    places = 3 - math.floor(math.log10(largest)) if largest > 0.0 else 0
    text = " ".join(f"{round(float(v), places) + 0.0:.4g}" for v in numbers)
    return f"({text})" if np.size(numbers) > 1 else text
