"""How a loop computed the speed if none was logged: candidates computed from positions, tested on the law."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from workbench.core import Recording

from .law import LawFit, fit_gains, ticks, unexplained
from .result import Remark

_OFF = 0.02  # relative deviation of a gain that is told
_ALIKE = 1.25  # times the least rest, within which one explanation is as good as another
_OVER = (1, 2, 3, 4, 6, 8)  # ticks of a difference
_PAST = 32  # ticks from which on every speed has its past
_TIMES = (1, 2, 4, 8, 16)  # ticks of a low-pass


@dataclass(frozen=True)
class Explanation:
    """A way to compute the speed, the lag of the loop's readings, and the law that follows."""

    speed: str
    late: int
    fit: LawFit
    to_controller: np.ndarray

    @property
    def off(self) -> dict[str, float]:
        """Return the gains that differ from the stated ones -> factor."""
        sure = max(_OFF, 2 * self.fit.rest)
        known = {k: f for k, (f, std) in self.fit.by_name.items() if k.startswith("k") and std < 0.1 * abs(f)}
        return {k: f for k, f in known.items() if abs(f - 1.0) > sure}

    def told(self, axes: Sequence[str]) -> str:
        """Return in words the speed, the row, and the gains that differ from the stated ones."""
        row = f"of {self.late} tick earlier" if self.late else "of the same row"
        named = [(name.rsplit("_", 1), factor) for name, factor in self.off.items()]
        gains = [
            f"{gain} of '{axes[int(i)]}' {factor:.4g} times the stated one" for (gain, i), factor in named
        ]
        return f"{self.speed}, {row}" + (f", and {', '.join(gains)}" if gains else "")


def explain_speed(
    recording: Recording, ratio: int, phase: int, tried: Sequence[np.ndarray]
) -> tuple[Explanation, ...]:
    """Return every way to compute the speed with which the law holds best; by the stated gains first.

    Args:
        recording: whose velocity was not measured.
        ratio, phase: rows per tick, and the row of the first.
        tried: candidates of M, which takes positions to the controller's.
    """
    # a log may begin while the machine moves: what was before its first rows no difference knows
    first = phase + ratio * min(_PAST, len(recording) // (4 * ratio))
    found = [
        Explanation(speed, late, fit, m)
        for speed, least, velocity in _speeds(recording, ratio)
        for late in range(least, 2)
        for m in tried
        for at in [ticks(recording.with_signals(velocity=velocity), ratio, first, late * ratio)]
        for fit in [fit_gains(at, recording.controller, m)]
    ]
    least = min(e.fit.rest for e in found)
    alike = [e for e in found if e.fit.rest <= _ALIKE * least]
    return tuple(sorted(alike, key=lambda e: (bool(e.off), e.fit.rest)))


def remark_on_speed(found: Sequence[Explanation], axes: Sequence[str]) -> Remark:
    """Return one remark on equally good explanations; of those with other gains, on the best."""
    best, *others = found
    stated = [e for e in others if not e.off]
    shown = [*stated[:2], *[e for e in others if e.off][:1]]
    rest = unexplained(best.fit.rest)
    text = f"With {best.told(axes)}, the logged command follows the stated law; {rest}."
    if shown:
        ways = "; ".join(e.told(axes) for e in shown)
        text += f" Equally good: {ways}. No speed was logged, so they cannot be distinguished."
    value = {
        "factors": {k: {"value": f, "std": s} for k, (f, s) in best.fit.by_name.items()},
        "unexplained": best.fit.rest,
        "to_controller": best.to_controller,
        "explanations": [e.told(axes) for e in found],
    }
    return Remark("note" if shown or best.off else "ok", "gains", None, text, value)


def _speeds(recording: Recording, ratio: int) -> Iterator[tuple[str, int, np.ndarray]]:
    """Return speeds (N, n) that a loop may have computed from the position: name, smallest lag in ticks."""
    q, tick = recording.position, ratio * recording.period
    back = (q - _before(q, ratio)) / tick
    made = "the speed as a difference"
    for n in _OVER:
        over = "one sample" if n == 1 else f"{n} samples"
        yield f"{made} of the position over {over}", 0, (q - _before(q, n * ratio)) / (n * tick)
    central = (_before(q, -ratio) - _before(q, ratio)) / (2 * tick)
    yield "the speed as a central difference of the position", 1, central
    for n in _TIMES:
        yield f"{made} behind a low-pass of {1e3 * n * tick:.3g} ms", 0, _passed(back, 1.0 / (1.0 + n), ratio)
    yield "a speed that was measured and not logged", 0, recording.velocity


def _before(x: np.ndarray, rows: int) -> np.ndarray:
    """Return x (N, n) shifted by this many rows, with the first (or last) row held."""
    at = np.clip(np.arange(len(x)) - rows, 0, len(x) - 1)
    return x[at]


def _passed(x: np.ndarray, share: float, ratio: int) -> np.ndarray:
    """Return a signal after a first-order low-pass from tick to tick, starting at any row."""
    out = np.empty_like(x)
    for first in range(ratio):
        part = x[first::ratio]
        start = (1.0 - share) * part[:1]
        out[first::ratio] = scipy.signal.lfilter([share], [1.0, share - 1.0], part, axis=0, zi=start)[0]
    return out
