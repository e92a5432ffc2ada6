"""The result of an inspection: frozen remarks that can be read and written as JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, is_dataclass
from typing import Any, Literal

import numpy as np

from workbench.core.shown import Shown
from workbench.recordings.noise import NoiseLevels

Severity = Literal["ok", "note", "warning", "problem"]


@dataclass(frozen=True)
class Remark:
    """One statement about the data.

    Attributes:
        severity: ``ok`` (checked and right), ``note`` (worth knowing), ``warning`` (probably wrong),
            ``problem`` (wrong).
        topic: ``clock``, ``unit``, ``sign``, ``swap``, ``gains``, ``controller``, ``delay``,
            ``saturation``, ``excitation`` or ``reader``.
        axis: the axis, or None where it concerns all.
        text: one sentence.
        value: the numbers behind it.
    """

    severity: Severity
    topic: str
    axis: str | None
    text: str
    value: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Excited:
    """The motion of one axis.

    Attributes:
        axis: its name.
        held: whether it stood still.
        position_range: lowest and highest position [rad or m].
        speed_max: 99.9 % quantile of the speed [rad/s or m/s].
        reversals: how often the direction of motion changed.
        band_hz: frequencies between which 98 % of the velocity's power lies [Hz].
        low_speed_share: part of the time below 5 % of `speed_max`.
    """

    axis: str
    held: bool
    position_range: tuple[float, float]
    speed_max: float
    reversals: int
    band_hz: tuple[float, float]
    low_speed_share: float


@dataclass(frozen=True)
class RecordingInspection:
    """All remarks on one recording."""

    recording: str
    rows: int
    period_s: float
    remarks: tuple[Remark, ...]
    noise: NoiseLevels
    excited: tuple[Excited, ...]


@dataclass(frozen=True, repr=False)
class Inspection(Shown):
    """All remarks on all recordings, in the order given."""

    _shown_by = "workbench.inspection.notebook"

    recordings: tuple[RecordingInspection, ...]

    @property
    def sound(self) -> bool:
        """Return whether nothing looks wrong: no remark is a warning or a problem."""
        bad = ("warning", "problem")
        return not any(remark.severity in bad for r in self.recordings for remark in r.remarks)


def inspection_dict(inspection: Inspection) -> dict[str, Any]:
    """Return the inspection as plain JSON values; an unknown number is None."""
    return {"format": 1, "sound": inspection.sound, "recordings": _plain(inspection.recordings)}


def _plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return _plain(asdict(value))
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, np.bool_ | np.integer):
        return value.item()
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value
