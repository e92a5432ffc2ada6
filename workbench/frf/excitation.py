"""An excitation as a value: one period of every experiment, and how often it is played."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from workbench.core import Excitation, InputError

from .lines import Grid
from .phases import crest_factor

Driven = Literal["torque_feedforward", "position_reference"]


@dataclass(frozen=True)
class Trial:
    """One experiment of a design: `name` (unique, names its files), `mode` of the inputs, `realisation`.

    Experiments of one realisation belong together: they share their phases and tell the inputs apart.
    """

    name: str
    mode: Literal["sum", "difference", "single"] | None = None
    realisation: int = 0


@dataclass(frozen=True, eq=False)
class Design:
    """What to play: E experiments of n axes, N samples per period.

    Attributes:
        name: the design's name.
        kind: ``"multisine"`` or ``"chirp"``.
        axes: driven axes, length n.
        driven: the signal played: torque on top of the feedback [N m or N], or position reference about
            `hold` [rad or m].
        rate_hz: samples per second.
        experiments: one period of each experiment, shape (E, N, n).
        lines: excited harmonics of the period, ascending, shape (F,).
        trials: one entry per experiment.
        grid: how the lines were chosen.
        periods: periods to play that count.
        transient_periods: periods to play before these, until the response has become periodic.
        hold: position reference of the posture, in the loop's own coordinates, length n; empty where no
            reference is played.
        fade_s: the first part of the first period over which the signal is faded in [s].
    """

    name: str
    kind: Literal["multisine", "chirp"]
    axes: tuple[str, ...]
    driven: Driven
    rate_hz: float
    experiments: np.ndarray
    lines: np.ndarray
    trials: tuple[Trial, ...]
    grid: Grid = "full"
    periods: int = 4
    transient_periods: int = 1
    hold: tuple[float, ...] = ()
    fade_s: float = 0.0

    def __post_init__(self) -> None:
        for name, kind in (("experiments", float), ("lines", int)):
            values = np.array(getattr(self, name), kind)
            values.flags.writeable = False
            object.__setattr__(self, name, values)
        self._check()

    def _check(self) -> None:
        e, rows, n = self.experiments.shape
        if not (np.isfinite(self.rate_hz) and self.rate_hz > 0):
            raise InputError(f"a rate of {self.rate_hz:g} Hz", column="rate_hz", remedy="give a positive one")
        if n != len(self.axes) or e != len(self.trials) or (self.hold and len(self.hold) != n):
            problem = f"{e} experiments of {n} columns for {len(self.trials)} trials of {len(self.axes)} axes"
            raise InputError(problem, column="experiments", remedy="give one column, and one hold, per axis")
        if not np.isfinite(self.experiments).all():
            raise InputError("the signal is not finite", column="experiments", remedy="check its amplitude")
        if self.periods < 1 or self.transient_periods < 0 or self.fade_s < 0:
            problem = f"{self.periods} periods after {self.transient_periods}, faded in for {self.fade_s:g} s"
            raise InputError(problem, column="periods", remedy="play one period or more")
        if len(self.lines) and 2 * self.lines[-1] >= rows:
            highest = self.lines[-1] * self.rate_hz / rows
            raise InputError(
                f"the line at {highest:g} Hz is not below half the rate of {self.rate_hz:g} Hz",
                column="f_max_hz", remedy="lower the band or raise the rate",
            )  # fmt: skip

    @property
    def period_s(self) -> float:
        """Period [s]."""
        return self.experiments.shape[1] / self.rate_hz

    @property
    def frequency(self) -> np.ndarray:
        """Frequencies of the lines [Hz], shape (F,)."""
        return self.lines / self.period_s

    @cached_property
    def spectrum(self) -> np.ndarray:
        """Amplitude times exp(j phase) of every line, shape (E, F, n), in the signal's unit."""
        rows = self.experiments.shape[1]
        return np.fft.rfft(self.experiments, axis=1)[:, self.lines] * (2 / rows)

    @property
    def crest_factors(self) -> np.ndarray:
        """Crest factor of every experiment and axis, shape (E, n)."""
        return crest_factor(np.swapaxes(self.experiments, 1, 2))

    @property
    def rows(self) -> int:
        """Return the number of rows played in one experiment, transient periods included."""
        return (self.periods + self.transient_periods) * self.experiments.shape[1]

    def scaled(self, factor: float) -> Design:
        """Return the same design with another amplitude."""
        return replace(self, experiments=self.experiments * factor)

    def excitation(self, experiment: int) -> Excitation:
        """Return what the recording of an experiment states about its excitation."""
        frequency = self.frequency
        return Excitation(
            kind=self.kind,
            mode=self.trials[experiment].mode,
            period_s=self.period_s,
            f_min_hz=float(frequency[0]),
            f_max_hz=float(frequency[-1]),
            lines=self.grid if self.kind == "multisine" else None,
        )

    def play(self, experiment: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Return all rows of an experiment and the columns of its table, as a rig plays them.

        Returns:
            ``(time, signals)``: time [s], shape (rows,), and by name ``torque_feedforward`` and/or
            ``position_reference``, each (rows, n).
        """
        time = np.arange(self.rows) / self.rate_hz
        signal = np.tile(self.experiments[experiment], (self.periods + self.transient_periods, 1))
        if self.fade_s > 0:
            signal *= (0.5 - 0.5 * np.cos(np.pi * np.clip(time / self.fade_s, 0, 1)))[:, None]
        signals = {}
        if self.hold:
            signals["position_reference"] = np.tile(np.array(self.hold, float), (self.rows, 1))
        signals[self.driven] = signal + signals.get(self.driven, 0.0)
        return time, signals
