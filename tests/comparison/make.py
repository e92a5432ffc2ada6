"""Logs of a leg with the sensors of the reference leg, made by the simulator that is compared."""

from __future__ import annotations

import numpy as np

from workbench.core import Recording
from workbench.models import Model
from workbench.simulation import Run, SensorNoise, simulate

ENCODER = 2 * np.pi / 2**14


def sensors(seed: int) -> SensorNoise:
    return SensorNoise(np.full(2, ENCODER), np.zeros(2), np.full(2, 0.015), np.full(2, 0.02), seed)


def measured(model: Model, asked: Recording, seeds: range) -> list[Recording]:
    """What the noisy log of each seed shows of one experiment."""
    runs = simulate([Run(model, asked, sensors(seed)) for seed in seeds])
    return [asked.with_signals(**run.signals) for run in runs]
