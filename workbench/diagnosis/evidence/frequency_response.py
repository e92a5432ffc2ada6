"""Lines on what measured frequency responses say about a finding, compared with the model's own runs.

Both are estimated from the same experiments in the same way, so that what the estimator does to one it does
to the other, and their ratio is what the model lacks: a delay turns its phase in proportion to frequency, a
gain lowers it alike everywhere, a soft coupling puts a dip and a top into it (R. Pintelon and J. Schoukens,
"System Identification: A Frequency Domain Approach", 2nd ed. 2012, ch. 2 and 4).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from workbench.core import EffectKey, Estimate, InputError, Recording
from workbench.effects import FrfSignature, SignalStage, effect_named
from workbench.frf import (
    Distortion,
    Frf,
    Resonance,
    distortion,
    estimate,
    find_resonances,
    group_by_posture,
    local_polynomial,
)
from workbench.report.numbers import interval

from ..policy import POLICY
from .weighted import BANDS, in_bands, weighted_mean, weighted_slope


@dataclass(frozen=True, eq=False)
class Responses:
    """One group of experiments: the recordings, the model's runs of them, and both responses."""

    measured: tuple[Recording, ...]
    modelled: tuple[Recording, ...]
    real: Frf
    model: Frf


def responses(measured: Sequence[Recording], simulated: Sequence[Recording]) -> Responses | None:
    """Return measured and modelled response of the first experiments that give one; None if none do.

    Multisines about one posture first, else chirps.

    Args:
        measured: recordings.
        simulated: the model's run of each, without noise.
    """
    pairs = {id(r): _as_run(r, s) for r, s in zip(measured, simulated, strict=True)}
    for kind, method in (("multisine", estimate), ("chirp", local_polynomial)):
        groups: dict[tuple[object, ...], list[Recording]] = {}
        for r in measured:
            e = r.excitation
            if e.kind == kind and (kind == "chirp" or e.period_s):
                groups.setdefault(
                    (e.period_s, e.f_min_hz, e.f_max_hz, e.lines, round(r.period, 9)), []
                ).append(r)
        for group in groups.values():
            for members in group_by_posture(group) if kind == "multisine" else [group]:
                runs = tuple(pairs[id(r)] for r in members)
                try:
                    real, model = method(members), method(runs)
                except (InputError, np.linalg.LinAlgError):
                    continue  # too few experiments or periods: nothing is said
                # above half the loop's rate stand images of what is below
                top_hz = min(0.5 / (r.controller.period_s or r.period) for r in members)
                real, model = _shared(real, model, top_hz)
                if len(real) >= POLICY.response_lines:
                    return Responses(tuple(members), runs, real, model)
    return None


def response_lines(found: Responses, key: EffectKey) -> list[str]:
    """Return lines on what the responses say about one effect; none if they cannot tell."""
    effect = effect_named(key.effect)
    side = "output" if effect.stage is SignalStage.SENSOR else "input"
    match effect.search.frf_signature:
        case FrfSignature.DELAY:
            return delay_line(found, key.axis, side)
        case FrfSignature.GAIN:
            return gain_line(found, key.axis, side)
        case FrfSignature.RESONANCE:
            return resonance_lines(found, key.axis)
        case FrfSignature.ODD:
            return distortion_lines(found, key.axis, even=False)
        case FrfSignature.EVEN:
            return distortion_lines(found, key.axis, odd=False)
        case None:
            return []


def delay_line(found: Responses, axis: str | None, side: str) -> list[str]:
    """Return a line on the slope of the ratio's phase [ms], if the phase is a straight line through zero."""
    omega, ratio, deviation = _ratio(found, axis, side)
    phase, weight = np.unwrap(np.angle(ratio)), 2.0 / (deviation / np.abs(ratio)) ** 2
    phase -= 2 * np.pi * np.round(np.average(phase[: len(phase) // BANDS]) / (2 * np.pi))
    slope, std = weighted_slope(omega, -phase, weight)
    rest = in_bands(omega, -phase - slope * omega, weight)
    off, share = POLICY.significant, POLICY.response_share
    straight = all(abs(m) < max(off * s, share * abs(slope) * at) for at, m, s in rest)
    if not (abs(slope) > POLICY.sure * std and straight):
        return []
    where = "" if axis is None else f" ({axis} {'torque' if side == 'input' else 'sensors'})"
    late = interval(Estimate(1e3 * slope, 1e3 * std, "ms"))
    return [
        f"the phase of the measured response{where} lags the modelled one in proportion to frequency up "
        f"to {omega[-1] / (2 * np.pi):.3g} Hz, as with a delay of {late} (95 %)"
    ]


def gain_line(found: Responses, axis: str | None, side: str) -> list[str]:
    """Return a line on the ratio's magnitude, if it is equal in all bands and the phase does not turn."""
    omega, ratio, deviation = _ratio(found, axis, side)
    size, weight = np.log(np.abs(ratio)), 2.0 / (deviation / np.abs(ratio)) ** 2
    mean, std = weighted_mean(size, weight)
    off, share = POLICY.significant, POLICY.response_share
    flat = all(abs(m - mean) < max(off * s, share * abs(mean)) for _, m, s in in_bands(omega, size, weight))
    turn = in_bands(omega, np.angle(ratio), weight)
    still = all(abs(m) < max(off * s, 2 * share * abs(mean)) for _, m, s in turn)
    if not (abs(mean) > POLICY.sure * std and flat and still):
        return []
    gain = float(np.exp(mean))
    where = "" if axis is None else f" ({axis} {'torque' if side == 'input' else 'sensor'})"
    band = f"{omega[0] / (2 * np.pi):.2g} to {omega[-1] / (2 * np.pi):.3g} Hz"
    size = interval(Estimate(gain, gain * std, "1"))
    return [
        f"the ratio of measured to modelled response{where} is {size} (95 %) in every band from {band}, "
        "without a phase shift"
    ]


def resonance_lines(found: Responses, axis: str | None) -> list[str]:
    """Return lines on pairs of anti-resonance and resonance that the model's own response does not have."""
    axes = [c.axis for c in found.real.inputs]
    lines = []
    for i, name in enumerate(axes):
        if axis not in (None, name):
            continue
        try:
            real = find_resonances(found.real, i, i)
            known = find_resonances(found.model, i, i, prominence_db=1.0)
        except InputError:
            return []
        new = [r for r in real if not any(_same(r, k) for k in known)]
        pair = _pair(new)
        if pair is not None:
            low, high = (interval(r.frequency) for r in pair)
            lines.append(
                f"{name} has an anti-resonance at {low} and a resonance at {high} (95 %) that the model "
                "does not have, typical of two inertias joined by a compliance"
            )
    return lines


def distortion_lines(found: Responses, axis: str | None, *, odd: bool = True, even: bool = True) -> list[str]:
    """Lines on distortion at lines that were not excited, if it exceeds the noise and the model's own."""
    try:
        real, model = distortion(found.measured), distortion(found.modelled)
    except (InputError, np.linalg.LinAlgError):
        return []  # every line was excited: nothing listens
    lines = []
    wanted = (("odd", odd, "dry friction or backlash"), ("even", even, "an offset, gravity or an asymmetry"))
    for kind, asked, cause in wanted:
        places = [k for k, c in enumerate(found.real.outputs) if axis in (None, c.axis)]
        best = max(places, key=lambda k: _share(real, kind, k), default=None) if asked else None
        if best is None:
            continue
        share, own = _share(real, kind, best), _share(model, kind, best)
        if share > 0 and share > POLICY.distortion_times * own:
            name = found.real.outputs[best].axis
            lines.append(
                f"{kind} distortion of {100 * share:.2g} % in the motion of {name}, at lines that were "
                f"not excited and above the noise; the model's own run has {100 * own:.2g} %. Typical "
                f"cause: {cause}"
            )
    return lines


def _share(d: Distortion, kind: str, output: int) -> float:
    return float(np.nan_to_num(getattr(d, kind)[output]))


def _as_run(recording: Recording, run: Recording) -> Recording:
    """Return the recording with the signals that the model produced in place of the measured ones."""
    made = {name: v for name, v in run.signals.items() if name in recording.signals}
    return recording.with_signals(**made)


def _shared(real: Frf, model: Frf, top_hz: float) -> tuple[Frf, Frf]:
    """Return both responses at the lines below a frequency that both have."""
    at = np.round(real.frequency, 9), np.round(model.frequency, 9)
    own, other = (np.where(a < top_hz, a, -k) for k, a in enumerate(at, 1))
    return real.kept(np.isin(own, other)), model.kept(np.isin(other, own))


def _ratio(found: Responses, axis: str | None, side: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return measured over modelled response of one input's column (or output's row), weighted by certainty.

    Returns:
        omega [rad/s], ratio (complex) and its deviation, each (L,), at the lines that say something.
    """
    g, model, std = found.real.response, found.model.response, found.real.std
    channels = found.real.inputs if side == "input" else found.real.outputs
    place = [k for k, c in enumerate(channels) if axis in (None, c.axis)]
    pick = (slice(None), slice(None), place) if side == "input" else (slice(None), place, slice(None))
    g, model, std = (x[pick].reshape(len(found.real), -1) for x in (g, model, std))
    weight = 1.0 / np.maximum(std, 1e-6 * np.abs(g)) ** 2
    information = np.sum(weight * np.abs(model) ** 2, axis=1)
    ratio = np.sum(weight * model.conj() * g, axis=1) / information
    deviation = 1.0 / np.sqrt(information)
    sure = deviation < POLICY.response_certain * np.abs(ratio)
    if np.count_nonzero(sure) < POLICY.response_lines:
        return np.ones(2), np.ones(2, complex), np.ones(2)  # says nothing
    return found.real.omega[sure], ratio[sure], deviation[sure]


def _same(a: Resonance, b: Resonance) -> bool:
    near = abs(a.frequency.value - b.frequency.value) < POLICY.resonance_near * b.frequency.value
    return a.kind == b.kind and near


def _pair(found: Sequence[Resonance]) -> tuple[Resonance, Resonance] | None:
    """Return the lowest anti-resonance that a resonance follows."""
    for low, high in pairwise(found):
        if (low.kind, high.kind) == ("antiresonance", "resonance"):
            return low, high
    return None
