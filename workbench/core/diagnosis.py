"""The result of diagnosing: frozen values that can be read, drawn and written as JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from .finding import EffectKey, Estimate, Finding
from .results import Comparison, Share
from .shown import Shown

Verdict = Literal["missing_effect", "partly_explained", "consistent", "unexplained"]
#: Why a search ended: noise explains the rest, its budget of simulations was spent, or nothing tried helps.
Stopped = Literal["noise", "budget", "nothing_helps"]


@dataclass(frozen=True, repr=False)
class Diagnosis(Shown):
    """The missing physical effects, how certain they are, what else it could be, what to measure next.

    Attributes:
        model: the model's name.
        verdict: ``missing_effect`` where the findings explain nearly all, ``partly_explained`` where they are
            certain and more than that is missing, ``consistent`` or ``unexplained``.
        error, noise_error: of the model as given, on the recordings used for fitting.
        holdout_noise_error: the noise floor of held-out recordings; None where there are none.
        findings: effects to add, best first; empty where the verdict is ``consistent`` or ``unexplained``.
        unexplained_fraction: share of squared error above the noise that stays (0 to 1).
        where: where that rest sits.
        next_experiment: what to measure to know more; None when nothing is open.
        not_excited: effects that this data could not have shown.
        ranking: every candidate tried: (key, share of the squared error above the noise that it removes by
            itself), best first.
        before, after: the comparisons behind the verdict.
        held_out: the same two of held-out recordings; None where there are none.
        settled: properties of the model that the findings were fitted with and that the model as given has
            not: ``sliding_speed`` [rad/s], ``flank_retardation_s`` [s], ``full_braking`` (0 or 1).
        evidence: what the unexplained rest goes with, one line each.
        shapes: smooth functions that the torque of that rest follows, what removes most first; no causes.
        used: share of the recordings' rows that were looked at; less than 1 where logs are long.
        notes: what stands for them, one line each.
        near: effects that lower the error and are not certain enough to be named.
        stopped: why the search ended.
        work: what the search simulated, in steps of one coordinate; the same on any machine.
        identifiability: what the recordings can tell apart; None where nothing linear can be asked.
        disagreeing: recordings that an effect explains with a size of its own each.
        trace: what was tried, in this order.
        mend: stated numbers that are wrong, with file, line, and what they should be, one line each.
        mend_recordings: findings that are wrong gains of recordings: `mend` says what to write there, and a
            model does not need them.
        by_links: share of the torque that stays which several wrong numbers of the links explain together, of
            which none has a name; 0 where that is not shown.
    """

    model: str
    verdict: Verdict
    error: float
    noise_error: float
    findings: tuple[Finding, ...]
    unexplained_fraction: float
    where: tuple[Share, ...]
    next_experiment: str | None
    not_excited: tuple[EffectKey, ...]
    ranking: tuple[tuple[EffectKey, float], ...] = ()
    before: Comparison | None = None
    after: Comparison | None = None
    held_out: tuple[Comparison, Comparison] | None = None
    evidence: tuple[str, ...] = ()
    shapes: tuple[Shape, ...] = ()
    settled: Mapping[str, float] = field(default_factory=dict)
    used: float = 1.0
    notes: tuple[str, ...] = ()
    holdout_noise_error: float | None = None
    near: tuple[Finding, ...] = ()
    stopped: Stopped = "nothing_helps"
    work: float = 0.0
    identifiability: Identifiability | None = None
    disagreeing: tuple[Disagreement, ...] = ()
    trace: tuple[Tried, ...] = ()
    mend: tuple[str, ...] = ()
    mend_recordings: tuple[EffectKey, ...] = ()
    by_links: float = 0.0


@dataclass(frozen=True)
class Identifiability:
    """Which small effects the recordings can tell apart, computed before any search.

    Attributes:
        separable: effects that each differ from any other.
        groups: effects that stand for one another.
        not_excited: effects that do not show.
        expected: of those that do, fitted alone: a small value of each parameter with its deviation.
    """

    separable: tuple[EffectKey, ...]
    groups: tuple[tuple[EffectKey, ...], ...]
    not_excited: tuple[EffectKey, ...]
    expected: tuple[tuple[EffectKey, Mapping[str, Estimate]], ...]

    @property
    def count(self) -> int:
        """Return the number of effects in all places."""
        return len(self.separable) + len(self.not_excited) + sum(map(len, self.groups))


@dataclass(frozen=True)
class Disagreement:
    """Recordings that an effect explains one at a time, but not together with one size.

    Attributes:
        recordings: their names.
        key: the effect.
        values: its size in each of them.
        parameter: whose value that is; empty where the effect has but one.
        meaning: two units that may have been taken for one another; empty where none are known.
    """

    recordings: tuple[str, ...]
    key: EffectKey
    values: tuple[float, ...]
    parameter: str = ""
    meaning: str = ""


@dataclass(frozen=True)
class Tried:
    """One attempt of a search, and its outcome.

    Attributes:
        move: what was tried, in words.
        begun_with: effects of the model that it began from.
        added: effects that came one after the other from there, each with what its best rivals would have
            removed of the squared error above the noise by themselves, best first.
        effects: effects in the end, fitted together.
        times_noise: error over noise, at the start and after each of `added`.
        explained: share of the squared error above the noise that is gone in the end.
        parameters: number of free parameters in the end.
        taken: whether it took the place of the best so far.
        why: why, or why not.
    """

    move: str
    begun_with: tuple[EffectKey, ...]
    added: tuple[tuple[EffectKey, tuple[tuple[EffectKey, float], ...]], ...]
    effects: tuple[EffectKey, ...]
    times_noise: tuple[float, ...]
    explained: float
    parameters: int
    taken: bool
    why: str


@dataclass(frozen=True, eq=False)
class Shape:
    """A smooth function, or a tone, that the residual torque of one axis follows: a description, no cause.

    Attributes:
        axis: whose torque.
        quantities: what it is a function of, one or two, in words.
        units: of these.
        torque_unit: N m or N.
        share: of the torque's power that it removes on blocks that it was not fitted to.
        grid: (G,) values of the first quantity.
        torque: (G,) the function there; of two quantities, where the second is at its median.
        std: (G,) its standard deviation.
        seen: (G,) the function and the mean of what it leaves around each value; NaN where nothing was
            recorded.
        frequency: of a tone [Hz], else None.
    """

    axis: str
    quantities: tuple[str, ...]
    units: tuple[str, ...]
    torque_unit: str
    share: float
    grid: np.ndarray
    torque: np.ndarray
    std: np.ndarray
    seen: np.ndarray
    frequency: float | None = None

    @property
    def name(self) -> str:
        """Return what it is, in words."""
        if self.frequency is not None:
            return f"a tone of {self.frequency:.3g} Hz"
        return f"a smooth function of {' and '.join(self.quantities)}"
