"""What running a model on recordings gives."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core import Recording

from .noise import NoiseModel


@dataclass(frozen=True)
class Simulated:
    """A model's runs of recordings, without noise and with it.

    `clean`: one a recording. `noisy`: one list a draw. `noise`: the sensors.
    """

    recordings: tuple[Recording, ...]
    clean: tuple[Recording, ...]
    noisy: tuple[tuple[Recording, ...], ...]
    noise: NoiseModel
