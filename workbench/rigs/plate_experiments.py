"""Experiments of the leg on a force plate: press, step and slide, as paths of the foot.

The reference goes below the plate, so that the loop presses the foot on it.
"""

from __future__ import annotations

import numpy as np

from workbench.core import Excitation

from .experiments import ROW_PERIOD, Experiment
from .standing_leg import Plate, reach


def plate_experiments(seed: int = 0, duration: float = 2.0) -> tuple[Experiment, ...]:
    """Return press, step, slide, and a mixture for testing that `seed` draws; `duration` [s] each."""
    t = np.arange(round(duration / ROW_PERIOD)) * ROW_PERIOD
    ease = np.clip(t / 0.3, 0.0, 1.0) ** 2 * (3.0 - 2.0 * np.clip(t / 0.3, 0.0, 1.0))
    wave = 2.0 * np.pi * t
    press = 0.012 + 0.005 * np.sin(1.3 * wave) + 0.003 * np.sin(4.1 * wave)
    step = 0.004 + 0.012 * np.sin(1.7 * wave)
    level = 0.007 + 0.003 * np.sin(2.3 * wave)
    sway = 0.08 * np.sin(0.8 * wave)
    generator = np.random.default_rng([seed, 8])
    f, g = generator.uniform(1.2, 2.2), generator.uniform(0.6, 1.2)
    start = generator.uniform(0.0, 6.28)
    mixed = 0.006 + 0.01 * (np.sin(f * wave + start) - np.sin(start) * (1.0 - ease))
    drift = 0.06 * np.sin(g * wave)
    return (
        _path("press", 0.01 * np.sin(0.7 * wave), press * ease),
        _path("step", 0.02 * np.sin(0.9 * wave), step * ease),
        _path("slide", sway, level * ease),
        _path("walk", drift, mixed * ease),
    )


def _path(name: str, forward: np.ndarray, below: np.ndarray) -> Experiment:
    """The foot's centre goes along (N,) [m], so far below where it just touches [m]."""
    plate = Plate()
    centre = plate.height + plate.radius
    joints = np.array([reach(x, centre - z) for x, z in zip(forward, below, strict=True)])
    return Experiment(name, joints, np.zeros_like(joints), Excitation("reference"))
