"""Reads, checks and writes what was measured: one TOML file and one table per recording."""

from .noise import NoiseLevels, noise_levels, white_noise
from .read import load_recording, load_recordings
from .write import save_recording

__all__ = [
    "NoiseLevels",
    "load_recording",
    "load_recordings",
    "noise_levels",
    "save_recording",
    "white_noise",
]
