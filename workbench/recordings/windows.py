"""Windows of long logs: spread over the log, and chosen for what they excite."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import Excitation, Recording

from .log import Log, Stretch

#: Rows times axes squared that a diagnosis holds at a time in about a gigabyte: what effects change along a
#: motion is a number for every effect in every place, and their number grows with that of axes.
AT_ONCE = 1_700_000
_HELD_OUT = 0.25  # of that, where recordings are held out
_COUNT = 8  # windows, of which a log's are about this long or shorter
_SHORTEST_S, _LONGEST_S = 2.0, 30.0
_FEWEST = 4
_WHOLE = 0.9  # of a window's rows must have been measured
_BEGIN_S = 0.025
_SMOOTH_S = 0.01  # over which a speed is averaged before its sign is looked at


@dataclass(frozen=True)
class Excerpts:
    """Recordings to fit and to test, and the share of all rows that they contain.

    `notes` say what stands for which log.
    """

    training: list[Recording]
    held_out: list[Recording]
    share: float = 1.0
    notes: tuple[str, ...] = ()


def excerpts(
    training: Sequence[Recording | Log], held_out: Sequence[Recording | Log] = (), at_once: float = AT_ONCE
) -> Excerpts:
    """Return recordings as they are, and windows in place of long logs.

    Args:
        training, held_out: recordings and logs.
        at_once: rows times axes squared to be held, as `AT_ONCE`.

    Raises:
        InputError: a log that cannot be read.
    """
    part = _HELD_OUT if held_out else 0.0
    notes: list[str] = []
    fit = _shortened(training, (1.0 - part) * at_once, notes)
    judge = _shortened(held_out, part * at_once, notes)
    every = sum(s.rows if isinstance(s, Log) else len(s) for s in (*training, *held_out))
    used = sum(len(r) for r in (*fit, *judge))
    return Excerpts(fit, judge, used / every if notes else 1.0, tuple(notes))


def _shortened(sources: Sequence[Recording | Log], at_once: float, notes: list[str]) -> list[Recording]:
    out: list[Recording] = []
    logs = [s for s in sources if isinstance(s, Log)]
    taken = sum(len(s) * len(s.axes) ** 2 for s in sources if isinstance(s, Recording))
    long = sum(log.duration for log in logs)
    for source in sources:
        if isinstance(source, Recording):
            out.append(source)
            continue
        room = max(at_once - taken, 0.0) * source.duration / long / len(source.axes) ** 2
        own = windows_of(source, room * source.period)
        seconds = sum(r.duration for r in own)
        share, each = 100 * seconds / source.duration, seconds / len(own)
        notes.append(
            f"{source.name}: of {source.duration:.0f} s, {len(own)} windows of {each:.0f} s were used "
            f"({share:.2g} %), spread over the log and chosen for what they excite; slow effects, such "
            "as heating, cannot be seen in them"
        )
        out += own
    return out


def windows_of(log: Log, total: float) -> list[Recording]:
    """Return windows of a log in order, `total` seconds together (at least four of two seconds).

    The log is divided into as many spans as there are windows, and each gives the one that adds most to what
    those before it excite: motion, speed, torque, and reversals of every axis.
    """
    length = float(np.clip(total / _COUNT, _SHORTEST_S, _LONGEST_S))
    count = max(_FEWEST, int(total / length))
    stretches = log.stretches(length)
    told = [(s.start, _excited(s)) for s in stretches]
    good = [(start, x) for start, x in told if x is not None] or [(s, np.ones(1)) for s, _ in told]
    table = np.stack([x for _, x in good])
    table = table / np.maximum(np.quantile(table, 0.99, axis=0), 1e-300)
    have, starts = np.zeros(table.shape[1]), []
    for span in np.array_split(np.arange(len(good)), min(count, len(good))):
        # a concave sum: what is there already adds little
        gain = np.sum(np.sqrt(have + table[span]), axis=1)
        best = int(span[np.argmax(gain)])
        have += table[best]
        starts.append(good[best][0])
    return [_window(log, s) for s in log.windows(starts, length)]


def _excited(stretch: Stretch) -> np.ndarray | None:
    """Return what a window excites: positive numbers per axis and kind; None if too little was measured."""
    r = stretch.recording
    if np.mean(r.valid) < _WHOLE:
        return None
    q, w = r.position[r.valid], r.velocity[r.valid]
    torque = r.get("torque_measured")
    torque = r.get("torque_command") if torque is None else torque
    wide = max(1, round(_SMOOTH_S / r.period))
    blocks = len(w) // wide
    slow = w[: blocks * wide].reshape(blocks, wide, -1).mean(axis=1)
    turns = np.sum(slow[1:] * slow[:-1] < 0, axis=0).astype(float)
    parts = [q.var(axis=0), np.mean(w**2, axis=0), turns]
    if torque is not None:
        parts += [torque[r.valid].var(axis=0), np.abs(torque[r.valid]).max(axis=0)]
    return np.concatenate(parts)


def _window(log: Log, stretch: Stretch) -> Recording:
    r = stretch.recording
    # readings say only roughly where it begins; what follows masked rows is masked until that is forgotten
    valid = np.array(r.valid)
    valid[: round(_BEGIN_S / r.period)] = False
    # of a periodic excitation a window holds no whole number of periods
    said = {"name": f"{log.name}, {stretch.start:.0f} s", "excitation": Excitation("reference")}
    return replace(r, valid=valid, **said)
