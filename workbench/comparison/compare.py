"""Run a model the way recordings were made, and say how far it is from them and from the noise."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import (
    HOPELESS,
    Comparison,
    InputError,
    InverseDynamics,
    Recording,
    RecordingError,
    Share,
    SimulationError,
)
from workbench.effects import axis_units
from workbench.models import Model, limits_left_out
from workbench.simulation import check_axes

from .consistent import MARGIN_TOTAL, consistent, outlier_of
from .floating import with_base
from .grounded import force_squares
from .inverse import inverse_dynamics
from .lines import line_shares
from .noise import DRAWS, NoiseModel
from .notes import notes_of
from .replay_of import replay_of
from .score import Scale, normalised, pooled, scored_signals, squares
from .simulated import Simulated
from .soft_friction import softness_note
from .standing import check_ground, on_ground
from .touching import contact_notes, refuse_overlaps
from .unlogged import readings
from .where import locate

_FEWEST = 30  # rows: from fewer neither their noise nor the start of a run can be told


def simulate_with_noise(
    model: Model,
    recordings: Sequence[Recording],
    *,
    draws: int = DRAWS,
    seed: int = 0,
    noise: NoiseModel | None = None,
) -> Simulated:
    """Run every recording once without noise and `draws` times with it, in one batch.

    `noise` are the sensors, where they are known already; else the recordings say.

    Raises:
        SimulationError: the model is unstable in a recording's loop.
    """
    return replay_of(model, recordings, noise).with_noise(model, seed, draws)


def matched(model: Model, recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    """Recordings as they are compared with this model: with the axes of a base that floats, and with what
    their logs leave open of the loop by the likeliest answer.

    Raises:
        InputError: as `matched_ways`.
    """
    return matched_ways(model, recordings)[0]


def matched_ways(model: Model, recordings: Sequence[Recording]) -> tuple[tuple[Recording, ...], ...]:
    """The same by all answers that may be right to what their logs leave open, the likeliest first.

    Raises:
        InputError: none given, other axes, a base that floats on one side only, a transmission that
            changes with the posture, very few rows, or links that overlap wherever they were.
    """
    if not recordings:
        raise InputError("no recordings given", remedy="name at least one recording's TOML file")
    if model.posture_dependent:
        raise InputError(
            f"the transmission of '{model.name}' changes with the posture; recordings are replayed through a "
            "constant one", file=model.source, column="transmission.posture_dependent",
            remedy="check and normalize know such mechanisms; compare and diagnose do not yet",
        )  # fmt: skip
    out = tuple(with_base(r, model) for r in recordings)
    for r in out:
        check_axes(r, model)
        if len(r) < _FEWEST:
            raise InputError(
                f"{len(r)} rows are too few to tell motion from noise", file=r.source,
                remedy=f"record for longer, {_FEWEST} rows at least and seconds of motion",
            )  # fmt: skip
        if on_ground(r):
            check_ground(model, r)
    refuse_overlaps(model, out)
    return readings(model, out)


def compare(
    model: Model, recordings: Sequence[Recording], *, draws: int = DRAWS, seed: int = 0
) -> Comparison:
    """Hold a model against recordings.

    Args:
        model: what we believe.
        recordings: what was measured; loops of kind ``unknown`` are compared by inverse dynamics.
        draws: noise simulations behind the floor.
        seed: of those.

    Raises:
        InputError: recordings that do not fit the model.
        SimulationError: the model is unstable in the recording's loop, or noise throws it further off than
            all that was measured.
    """
    replay = replay_of(model, matched(model, recordings))
    simulated = replay.with_noise(model, seed, draws)
    out = told(evaluate(model, simulated))
    return replace(out, notes=(*out.notes, *filter(None, [softness_note(model, replay, simulated)])))


def told(result: Comparison) -> Comparison:
    """A comparison that says something.

    Raises:
        SimulationError: noise alone throws the model further off than all that was measured.
    """
    floor = result.noise_error - 3.0 * result.noise_error_std
    recordings = [entry.recording for entry in result.recordings]
    if noise_rules(floor, recordings):
        raise SimulationError(cannot_run(result.model, result.noise_error, ground=on_ground(recordings[0])))
    return result


def noise_rules(floor: float, recordings: Sequence[Recording]) -> bool:
    """Whether a noise floor is so large that no error can be told from it.

    A machine that never moved would leave an error of 1: a floor above is no nearer to the data. Where little
    but noise was measured, that is all there is to explain, and a run from a noisy state has it twice.
    """
    levels = NoiseModel.of(recordings).levels
    sensors = normalised(np.stack([levels.position_std, levels.torque_std]) ** 2, Scale.of(recordings))
    return floor > max(MARGIN_TOTAL, HOPELESS * np.nan_to_num(sensors))


def cannot_run(model: str, floor: float, *, ground: bool = False) -> str:
    """What is said of a model whose noise floor `noise_rules`; what to look at first, on the `ground` too."""
    return (
        f"model '{model}' cannot run these loops: noise alone throws it {floor:.3g} times as far off as all "
        "that was measured; check the order of the axes, units, signs and gains, and what touches what"
    ) + (", where the ground is and how soft ([ground]), and log base_velocity" if ground else "")


def evaluate(model: Model, simulated: Simulated) -> Comparison:
    """Score runs that were made already."""
    recordings = simulated.recordings
    parts = [Sums.of(simulated, i) for i in range(len(recordings))]

    def where(entries: Sequence[RecordingError]) -> tuple[Share, ...]:
        return (*line_shares(entries), *locate(entries, simulated.noisy, axis_units(model)))

    free = not any(map(on_ground, recordings))
    inverse = inverse_dynamics(model, recordings, simulated.clean, simulated.noise.levels) if free else None
    notes = (*notes_of(recordings), *contact_notes(model, recordings))
    return concluded(model, parts, Scale.of(recordings), where, inverse, notes)


@dataclass(frozen=True)
class Sums:
    """What is left of one recording, summed over its valid rows.

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
        """Of one recording of those that were run."""
        r, clean = simulated.recordings[index], simulated.clean[index]
        names = scored_signals(r)
        noise = np.stack([squares(draw[index], clean, names) for draw in simulated.noisy])
        return Sums(
            r, clean, squares(r, clean), noise, int(np.sum(r.valid)), simulated.immaterial(index),
            force=force_squares(simulated, index),
        )  # fmt: skip


def concluded(
    model: Model,
    parts: Sequence[Sums],
    scale: Scale,
    where: Callable[[Sequence[RecordingError]], tuple[Share, ...]],
    inverse: InverseDynamics | None,
    notes: tuple[str, ...],
) -> Comparison:
    """The comparison that sums say; `where` is asked where noise does not explain the error."""
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
    fine = consistent(error_ms, draws_ms, error, floors, allowed)
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
        notes=(*notes, *filter(None, [limits_left_out(model)])),
        outlier=outlier_of(model.axes, error_ms, draws_ms, allowed),
    )
