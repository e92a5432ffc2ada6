"""Commands of a run, tick by tick, and its frames, so that the run can be compared with a model."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from workbench.can import CanConfig, Wire
from workbench.core import InputError
from workbench.core.files import write_whole

from .base import BaseMotion
from .controller import Controller, Target
from .frame_log import ProcessLog, WireLog
from .joints import Joints
from .ports import refuse_unheard

PLAYED = ".played.npz"  #: beside a log: the references of its ticks
_LONGEST = 600.0  # s; of twelve joints 40 MB


class Kept:
    """A controller that stores its commands while the robot runs, for at most ten minutes.

    Args:
        inner: decides.
        joints: whose limits the references are held to.
        period: of the loop [s].
        seconds: how long it runs at most.
    """

    def __init__(self, inner: Controller, joints: Joints, period: float, seconds: float) -> None:
        self._inner, self._joints, self._period = inner, joints, period
        self._begun: float | None = None
        # all of it at once: nothing is allocated in the loop
        ticks = int(min(seconds, _LONGEST) / period) + 1
        self._rows = np.full((2, ticks, len(joints.matrix)), np.nan)

    def target(
        self, now: float, phase: str, position: np.ndarray, velocity: np.ndarray, base: BaseMotion
    ) -> Target | None:
        """Return the targets of the controller."""
        asked = self._inner.target(now, phase, position, velocity, base)
        if phase == "run" and asked is not None and self._joints.sane(asked.reference):
            self._begun = now if self._begun is None else self._begun
            row = round((now - self._begun) / self._period)
            if row < self._rows.shape[1]:
                self._rows[:, row] = self._joints.within(asked.reference), asked.feedforward
        return asked

    @property
    def full(self) -> bool:
        """Return whether the longest time that is stored is over."""
        return bool(np.isfinite(self._rows[0, -1]).all())

    def write(self, log: Path, shift: float) -> None:
        """Write the rows beside a log; a missed tick repeats the last row; without a tick nothing is written.

        Args:
            log: of the frames.
            shift: the log's clock minus the loop's [s].
        """
        if self._begun is None:
            return
        known = np.flatnonzero(np.isfinite(self._rows[0]).all(axis=1))
        held = known[np.searchsorted(known, np.arange(known[-1] + 1), side="right") - 1]
        reference, feedforward = self._rows[:, held]
        made = io.BytesIO()
        np.savez(made, begun=self._begun + shift, reference=reference, feedforward=feedforward)
        write_whole(log.with_suffix(PLAYED), made.getvalue())


@contextmanager
def logged(
    config: CanConfig, log: Path, kept: Kept, wires: Mapping[str, Wire] | None
) -> Iterator[WireLog | ProcessLog]:
    """Log the frames of a run, and write the commands beside them at its end, whatever ended it.

    Args:
        config: whose buses are logged.
        log: its frames, as candump writes them; of a run that was there before nothing is left.
        kept: the run's controller.
        wires: virtual buses; None for those of the configuration.

    Raises:
        InputError: the folder cannot be written, or a bus that no other process can hear.
        RunError: the logger failed.
    """
    if wires is None:
        refuse_unheard(config)  # before anything is made
    try:
        log.parent.mkdir(parents=True, exist_ok=True)
        for file in (log, log.with_suffix(".clock"), log.with_suffix(PLAYED)):
            file.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"cannot be written ({error.strerror})", file=log) from error
    frames = ProcessLog(config, log) if wires is None else WireLog(wires, log)
    try:
        yield frames
    finally:
        kept.write(log, frames.close())
