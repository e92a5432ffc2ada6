"""Simulated runs of a model so far."""

from __future__ import annotations

from dataclasses import dataclass, field

from workbench.core import Comparison, Recording, RecordingError
from workbench.models import Model


@dataclass
class Runs:
    """Runs of a model as far as they are finished, and their score.

    Attributes:
        model: which.
        entries: recordings beside runs; None while only some have been simulated.
        shown: index to run, of those simulated so far.
        seen: the same, with those of the models just before where there are none yet.
        failed: it cannot be run.
        error: of all; None while some are missing.
        comparison: with the noise floor; None while it is computed.
    """

    model: Model
    shown: dict[int, Recording] = field(default_factory=dict)
    seen: dict[int, Recording] = field(default_factory=dict)
    failed: bool = False
    entries: tuple[RecordingError, ...] | None = None
    error: float | None = None
    comparison: Comparison | None = None
