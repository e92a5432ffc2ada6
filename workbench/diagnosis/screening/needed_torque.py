"""The torque that a model needs along the measured motion, and the rows of it that are used."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.effects import Motion

from .sensitivity import Linearisation

_PER_CYCLE = 4  # rows kept per cycle of the filter's corner frequency: behind it nothing is faster


def kept_rows(linearisation: Linearisation, index: int) -> np.ndarray:
    """Return the rows (M,) of a recording that keep everything that the filter passes."""
    corner = linearisation.loops[index].reading.corner_hz
    step = max(1, int(1.0 / (_PER_CYCLE * corner * linearisation.data.recordings[index].period)))
    return np.arange(0, len(linearisation.data.recordings[index]), step)


def needing(linearisation: Linearisation) -> list[Motion]:
    """Return the motions with the torque that the model needs for them in place of the measured one.

    What is made of a measured torque explains it by itself wherever the model needs little.
    """
    out = []
    for motion, run, loop in zip(linearisation.motions, linearisation.runs, linearisation.loops, strict=True):
        reading = loop.reading
        unmodelled = reading.recording.signals[reading.name] - run.signals[reading.name]
        out.append(replace(motion, torque=motion.torque - unmodelled @ np.linalg.inv(reading.to_actuator)))
    return out
