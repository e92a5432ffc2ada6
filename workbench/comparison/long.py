"""Comparison with logs that are too long for memory: in stretches, summed over all rows."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import Comparison, InputError, InverseDynamics, Recording, RecordingError, Share
from workbench.effects import axis_units, compile_plant
from workbench.models import Model
from workbench.recordings import Log, Stretch
from workbench.simulation import scored_torque

from .compare import compare, told
from .evaluate import Sums, concluded
from .inverse import inverse_of, torque_sums
from .lines import line_shares
from .matching import matched
from .noise import DRAWS
from .notes import notes_of
from .replay import Replay
from .replay_of import replay_of
from .score import Scale, follows_motion, normalised
from .simulated import Simulated
from .standing import on_ground
from .survey import Survey
from .touching import contact_notes
from .where import Excess

NUMBERS = 240_000  # rows times axes of a stretch: some 200 MB with the runs of it
_LEAD_S = 1.0  # before a stretch, in which a loop forgets that it was begun with noisy readings
KEPT = 200_000  # rows of a log that say where its error sits


def compare_logs(
    model: Model,
    sources: Sequence[Recording | Log],
    *,
    draws: int = DRAWS,
    seed: int = 0,
    progress: Callable[[str, float], None] = lambda text, done: None,
) -> Comparison:
    """Return the comparison of a model with recordings of which some are long logs; without long logs, that
    of `compare`.

    A log is run in stretches, each from the state measured a second before it, so that what is summed is what
    one run of all of it would leave, but for machines that remember longer: heat begins anew, and a machine
    that nothing holds drifts from each stretch's beginning. Mean squares, the score and the noise floor are
    those of every row. A long log's entry shows its worst stretch.

    Args:
        model: what we believe.
        sources: recordings and logs.
        draws, seed: of the noise simulations.
        progress: told what is being done, and which part of it is.

    Raises:
        InputError, SimulationError: as `compare`.
    """
    held = [s for s in sources if isinstance(s, Recording)]
    if len(held) == len(sources):
        return compare(model, held, draws=draws, seed=seed)
    if model.floats:
        raise InputError(
            f"the base of model '{model.name}' floats, and such models cannot run on logs that do not fit "
            "into memory",
            file=next(s.source for s in sources if not isinstance(s, Recording)),
            remedy="cut shorter recordings out of them",
        )  # fmt: skip
    progress("reading the logs", 0.0)
    survey = Survey(model)
    for source in sources:
        survey.add(source, _pieces(source))
    sample = matched(model, survey.sample)
    standing = next((r for r in sample if on_ground(r)), None)
    if standing is not None:
        raise InputError(
            "recordings on the ground cannot be run if they do not fit into memory", file=standing.source,
            column="columns.ground_force", remedy="cut shorter ones out of them",
        )  # fmt: skip
    replay = replay_of(model, sample)
    scale = survey.scale(replay.recordings)
    parts = []
    for i, source in enumerate(sources):
        part = _Part(source, replay, scale, max(1, survey.rows[i] // KEPT))
        for k, piece in enumerate(_pieces(source)):
            own = int(np.random.SeedSequence([seed, i, k]).generate_state(1)[0])
            part.add(model, piece, own, draws)
            progress(f"running {source.name}", (i + part.share) / len(sources))
        parts.append(part)
    sums = [p.sums() for p in parts]

    def where(entries: Sequence[RecordingError]) -> tuple[Share, ...]:
        shown = [replace(e, covers=None) for e in entries]
        spread = Excess.located([p.excess for p in parts], entries, axis_units(model))
        return (*line_shares(shown), *spread)

    notes = (*_notes(model, parts), *contact_notes(model, sample))
    return told(concluded(model, sums, scale, where, _inverse(parts), notes))


def _pieces(source: Recording | Log) -> Iterator[Stretch]:
    if isinstance(source, Recording):
        return iter([Stretch(source, 0.0, 0)])
    return source.stretches(NUMBERS / len(source.axes) * source.period, _LEAD_S)


@dataclass
class _Worst:
    """The stretch that is shown."""

    score: float
    start: float
    recording: Recording
    simulated: Recording


class _Part:
    """One source on its way through."""

    def __init__(self, source: Recording | Log, replay: Replay, scale: Scale, every: int) -> None:
        self.source, self.replay, self.scale = source, replay, scale
        self.error, self.noise, self.count = np.zeros(()), np.zeros(()), 0
        self.immaterial = np.zeros(())
        self.torque: np.ndarray | None = None
        self.worst: _Worst | None = None
        self.excess = Excess(every)
        self.stretches, self.share = 0, 0.0

    def add(self, model: Model, piece: Stretch, seed: int, draws: int) -> None:
        """Run a stretch, and sum what it leaves."""
        made = self.replay.like(model, [piece.recording]).with_noise(model, seed, draws)
        counted = _after(made.recordings[0], piece.lead)
        noisy = tuple((replace(draw[0], valid=counted.valid),) for draw in made.noisy)
        made = Simulated((counted,), made.clean, noisy, made.noise, made.shifted, made.creeping)
        count = int(np.sum(counted.valid))
        self.share = (piece.start + counted.duration) / max(self.source.duration, 1e-9)
        if not count:
            return
        own = Sums.of(made, 0)
        self.error, self.noise, self.count = (
            self.error + own.error,
            self.noise + own.noise,
            self.count + count,
        )
        self.immaterial = self.immaterial + own.immaterial
        self.stretches += 1
        if scored_torque(counted) is not None and model.size:
            levels = made.noise.levels
            sums = torque_sums(compile_plant(model), counted, made.clean[0], levels)
            self.torque = sums if self.torque is None else self.torque + sums
        score = normalised(own.error / count, self.scale)
        if self.worst is None or score > self.worst.score:
            self.worst = _Worst(score, piece.start, counted, made.clean[0])
        self.excess.add(counted, made.clean[0], [draw[0] for draw in made.noisy], piece.start)

    def sums(self) -> Sums:
        """Of all of it."""
        assert self.worst is not None
        covers = self.source.duration if isinstance(self.source, Log) else None
        shown = replace(self.worst.recording, name=self.source.name)
        worst = self.worst.simulated
        return Sums(shown, worst, self.error, self.noise, self.count, self.immaterial, covers)


def _after(recording: Recording, lead: int) -> Recording:
    """The recording with its first rows masked."""
    if not lead:
        return recording
    valid = np.array(recording.valid)
    valid[:lead] = False
    return replace(recording, valid=valid)


def _inverse(parts: Sequence[_Part]) -> InverseDynamics | None:
    known = [(p.torque, p.worst) for p in parts if p.torque is not None and p.worst is not None]
    if not known:
        return None
    return inverse_of(np.sum([torque for torque, _ in known], axis=0), known[0][1].recording)


def _notes(model: Model, parts: Sequence[_Part]) -> tuple[str, ...]:
    notes: list[str] = []
    for p in parts:
        assert p.worst is not None
        r, start = p.worst.recording, p.worst.start
        if isinstance(p.source, Recording):
            notes += notes_of([r])
            continue
        # what was done to the rows of one stretch was done to all of them
        notes += [n for n in notes_of([replace(r, name=p.source.name)]) if "rows are masked" not in n]
        notes.append(
            f"{p.source.name}: all {p.source.duration:.0f} s compared, in {p.stretches} stretches, each from "
            f"its measured state; curves show the worst, {start:.0f} to {start + r.duration:.0f} s"
        )
        if model.has("thermal_derating"):
            notes.append(f"{p.source.name}: the motors' temperature restarts with each stretch")
        if r.controller.kind == "none" and not follows_motion(r):
            notes.append(f"{p.source.name}: no controller holds the machine, so each stretch drifts")
    return tuple(notes)
