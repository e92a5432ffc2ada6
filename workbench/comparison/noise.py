"""The noise floor: the error of a perfect model, from sensor noise that passes through the sampled loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import Recording
from workbench.recordings import NoiseLevels, noise_levels, white_noise
from workbench.simulation import Experiment, SensorNoise, differentiates, rate_read

DRAWS = 4
_USUAL = 0.25  # quantile over recordings: motion only ever adds to what is taken for noise


def rig_noise(recordings: Sequence[Recording]) -> NoiseLevels:
    """Return the sensor noise of a rig: the lower quartile over its recordings, per axis, (n,) each."""
    levels = [noise_levels(r) for r in recordings]

    def usual(name: str) -> np.ndarray:
        values = np.stack([getattr(level, name) for level in levels])
        known = np.isfinite(values).any(axis=0)
        return np.where(known, np.nanquantile(np.where(known, values, 0.0), _USUAL, axis=0), np.nan)

    return NoiseLevels(
        *(usual(n) for n in ("position_resolution", "position_std", "velocity_std", "torque_std"))
    )


@dataclass(frozen=True)
class NoiseModel:
    """Sensor noise of a rig, from which draws are made."""

    levels: NoiseLevels

    @staticmethod
    def of(recordings: Sequence[Recording]) -> NoiseModel:
        """Return the noise that the recordings show for their own sensors."""
        return NoiseModel(rig_noise(recordings))

    def with_unlogged_rate(self, experiments: Sequence[Experiment]) -> NoiseModel:
        """Return the noise including that of a speed sensor which a loop reads but the log lacks."""
        read = [
            told[1]
            for e in experiments
            if "velocity" in e.recording.derived and not differentiates(e) and (told := rate_read(e))
        ]
        if not read or np.isfinite(self.levels.velocity_std).any():
            return self
        levels = [[white_noise(x, np.ones(len(x), bool)) for x in rate.T] for rate in read]
        return NoiseModel(replace(self.levels, velocity_std=np.median(levels, axis=0)))

    def draw(self, seed: int) -> SensorNoise:
        """Return one draw; encoder rounding is simulated as rounding, everything else as white noise."""
        resolution = np.nan_to_num(self.levels.position_resolution)
        rounding = resolution / np.sqrt(12.0)
        white = np.nan_to_num(self.levels.position_std)
        rest = np.sqrt(np.maximum(white**2 - rounding**2, 0.0))
        return SensorNoise(
            resolution=resolution,
            # what the median of many windows leaves below a tenth of the rounding is not noise
            position_std=np.where(rest > 0.3 * rounding, rest, 0.0),
            velocity_std=np.nan_to_num(self.levels.velocity_std),
            torque_std=np.nan_to_num(self.levels.torque_std),
            seed=seed,
        )


def noise_seeds(recordings: int, draws: int, seed: int) -> list[list[int]]:
    """Return distinct seeds, one list per draw with one number per recording."""
    children = np.random.SeedSequence(seed).generate_state(recordings * draws)
    return [[int(s) for s in children[d * recordings : (d + 1) * recordings]] for d in range(draws)]
