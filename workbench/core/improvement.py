"""The result of improving: the steps from a model to one that explains the data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from .diagnosis import Diagnosis, Verdict
from .finding import EffectKey, Estimate
from .results import Comparison
from .shown import Shown


@dataclass(frozen=True, repr=False)
class Step(Shown):
    """One effect added by `improve`, with the errors after it; `removed` lists what it made needless."""

    key: EffectKey
    parameters: Mapping[str, Estimate]
    error: float
    holdout_error: float | None
    indistinguishable_from: tuple[EffectKey, ...] = ()
    evidence: tuple[str, ...] = ()
    removed: tuple[EffectKey, ...] = ()


@dataclass(frozen=True, repr=False)
class Improvement(Shown):
    """All steps from a model to one that explains the data; fields of its diagnosis mean the same.

    Attributes:
        steps: effects added, in order: causes, or, where `nearest`, what comes nearest to unknown ones.
    """

    model: str
    steps: tuple[Step, ...]
    error_before: float
    error_after: float
    holdout_error_before: float | None
    holdout_error_after: float | None
    noise_error: float
    verdict: Verdict
    before: Comparison | None = None
    after: Comparison | None = None
    held_out: tuple[Comparison, Comparison] | None = None
    diagnosis: Diagnosis | None = None
    used: float = 1.0
    notes: tuple[str, ...] = ()
    holdout_noise_error: float | None = None
    nearest: bool = False

    @property
    def kept(self) -> tuple[Step, ...]:
        """Return the steps that count at the end: those that no later step made needless."""
        return tuple(
            step
            for i, step in enumerate(self.steps)
            if not any(step.key in later.removed for later in self.steps[i + 1 :])
        )

    @property
    def added(self) -> tuple[Step, ...]:
        """Return the steps whose effects the improved model has: `kept`, without wrong numbers of recordings.

        The errors of all steps are those with these numbers corrected.
        """
        mended = self.diagnosis.mend_recordings if self.diagnosis is not None else ()
        return tuple(step for step in self.kept if step.key not in mended)


#: What `compare`, `diagnose` and `improve` return.
Result = Comparison | Diagnosis | Improvement
