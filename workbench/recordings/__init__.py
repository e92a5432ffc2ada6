"""Recordings: read, checked and written; one TOML file and one table each."""

from .description import is_model_file
from .log import Log, Stretch, check_moves, open_recording, open_recordings
from .noise import NoiseLevels, noise_levels
from .read import describe, load_recording, source_files
from .several import Source, load_recordings
from .white_noise import white_noise
from .windows import Excerpts, excerpts
from .write import save_recording

__all__ = [
    "Excerpts", "Log", "NoiseLevels", "Source", "Stretch", "check_moves", "describe", "excerpts",
    "is_model_file", "load_recording", "load_recordings", "noise_levels", "open_recording", "open_recordings",
    "save_recording", "source_files", "white_noise",
]  # fmt: skip
