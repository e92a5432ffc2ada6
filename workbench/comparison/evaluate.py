"""Residual of simulated recordings, compared with the residual from noise alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import Comparison, InverseDynamics, Recording, RecordingError, Share
from workbench.effects import axis_units
from workbench.models import Model, free_joints, limits_left_out

from .consistent import consistent, outlier_of
from .inverse import inverse_dynamics
from .lines import line_shares
from .notes import notes_of
from .score import Scale, normalised, pooled, scored_signals, squares
from .simulated import Simulated
from .standing import FORCE, on_ground
from .touching import contact_notes
from .where import Excess


def evaluate(model: Model, simulated: Simulated) -> Comparison:
    """Return the comparison for runs that exist already."""
    recordings = simulated.recordings
    parts = [Sums.of(simulated, i) for i in range(len(recordings))]

    def where(entries: Sequence[RecordingError]) -> tuple[Share, ...]:
        parts, rate = [], max(1.0 / e.recording.period for e in entries)
        for k, e in enumerate(entries):
            parts.append(Excess(rate=rate))
            parts[-1].add(e.recording, e.simulated, [draw[k] for draw in simulated.noisy], 0.0)
        return (*line_shares(entries), *Excess.located(parts, entries, axis_units(model)))

    free = not any(map(on_ground, recordings)) and not model.posture_dependent
    inverse = inverse_dynamics(model, recordings, simulated.clean, simulated.noise.levels) if free else None
    notes = (*notes_of(recordings), *contact_notes(model, recordings))
    return concluded(model, parts, Scale.of(recordings), where, inverse, notes)


@dataclass(frozen=True)
class Sums:
    """Sums of the residual of one recording over its valid rows.

    Attributes:
        recording, simulated: what is shown of it.
        error: sums of squares (2, n) of measured minus simulated.
        noise: the same of each noise draw, (draws, 2, n).
        count: rows.
        immaterial: sums of squares (2, n) by which two right simulations may differ.
        covers: as of `RecordingError`.
        force: mean squares of the force on the feet (3 F,), measured minus simulated and of the noise.
    """

    recording: Recording
    simulated: Recording
    error: np.ndarray
    noise: np.ndarray
    count: int
    immaterial: np.ndarray
    covers: float | None = None
    force: tuple[np.ndarray, np.ndarray] | None = None

    @staticmethod
    def of(simulated: Simulated, index: int) -> Sums:
        """Return the sums of one recording and its runs."""
        r, clean = simulated.recordings[index], simulated.clean[index]
        names = scored_signals(r)
        noise = np.stack([squares(draw[index], clean, names) for draw in simulated.noisy])
        return Sums(
            r, clean, squares(r, clean), noise, int(np.sum(r.valid)), simulated.immaterial(index),
            force=_force_squares(simulated, index),
        )  # fmt: skip


def concluded(
    model: Model,
    parts: Sequence[Sums],
    scale: Scale,
    where: Callable[[Sequence[RecordingError]], tuple[Share, ...]],
    inverse: InverseDynamics | None,
    notes: tuple[str, ...],
) -> Comparison:
    """Return the comparison from the sums; `where` is called only if noise does not explain the error."""
    counts = [p.count for p in parts]
    entries = []
    for p in parts:
        error_ms = p.error / p.count
        noise_ms = np.mean(p.noise, axis=0) / p.count
        noise_ms = np.where(np.isfinite(error_ms), noise_ms, np.nan)
        entries.append(
            RecordingError(
                recording=p.recording,
                simulated=p.simulated,
                position_rmse=np.sqrt(error_ms[0]),
                torque_rmse=np.sqrt(error_ms[1]),
                position_noise=np.sqrt(noise_ms[0]),
                torque_noise=np.sqrt(noise_ms[1]),
                error=normalised(error_ms, scale),
                noise_error=normalised(noise_ms, scale),
                covers=p.covers,
                ground_force_rmse=None if p.force is None else np.sqrt(p.force[0]),
                ground_force_noise=None if p.force is None else np.sqrt(p.force[1]),
            )
        )
    error_ms = pooled([p.error for p in parts], counts)
    draws_ms = np.stack([pooled([p.noise[k] for p in parts], counts) for k in range(len(parts[0].noise))])
    floors = np.array([normalised(ms, scale) for ms in draws_ms])
    error, floor, spread = normalised(error_ms, scale), float(floors.mean()), float(floors.std(ddof=1))
    allowed = pooled([p.immaterial for p in parts], counts)
    fine = consistent(error_ms, draws_ms, scale, allowed)
    return Comparison(
        model=model.name,
        axes=model.axes,
        recordings=tuple(entries),
        error=error,
        noise_error=floor,
        noise_error_std=spread,
        consistent=fine,
        where=() if fine else where(entries),
        inverse_dynamics=inverse,
        notes=(*notes, *filter(None, [limits_left_out(model), free_joints(model)])),
        outlier=outlier_of(model.axes, error_ms, draws_ms, allowed),
    )


def _force_squares(simulated: Simulated, index: int) -> tuple[np.ndarray, np.ndarray] | None:
    """Return mean squares of the force on the feet, (3 F,) each: measured minus simulated, and noise.

    None where it was not measured.
    """
    measured, clean = simulated.recordings[index], simulated.clean[index]
    if not (FORCE in measured.extra and FORCE in clean.extra):
        return None
    rows, made = measured.valid, clean.extra[FORCE]
    noise = [(draw[index].extra[FORCE] - made)[rows] ** 2 for draw in simulated.noisy]
    return ((measured.extra[FORCE] - made)[rows] ** 2).mean(axis=0), np.mean(noise, axis=(0, 1))
