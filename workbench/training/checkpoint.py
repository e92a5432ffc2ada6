"""Checkpoints: written whole or not at all, read without running anything that they contain."""

from __future__ import annotations

import io
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch

from workbench.core import InputError
from workbench.core.files import write_whole


def save(path: Path, content: Mapping[str, Any]) -> None:
    """Replace the checkpoint at `path`; if this is interrupted, the previous one remains."""
    stream = io.BytesIO()
    torch.save(_tensors(content), stream)
    write_whole(path, stream.getvalue(), force=True)


def load(path: Path, device: str) -> dict[str, Any]:
    """Return a checkpoint: tensors, numbers and text, never code.

    Raises:
        InputError: there is none, or it is not one of ours.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of what is damaged torch warns before it raises
            content = torch.load(path, map_location=device, weights_only=True)
    except FileNotFoundError as error:
        raise InputError("no checkpoint here", file=path, remedy="name the folder of a run") from error
    except Exception as error:  # whatever a file can do to a reader
        raise InputError("not a checkpoint", file=path, remedy="name the folder of a run") from error
    if not isinstance(content, dict):
        raise InputError("not a checkpoint", file=path, remedy="name the folder of a run")
    return content


def _tensors(value: Any) -> Any:
    """The same with tensors for arrays, which are what a reader without pickle takes."""
    if isinstance(value, np.ndarray):
        return torch.from_numpy(np.array(value))
    if isinstance(value, Mapping):
        return {key: _tensors(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_tensors(inner) for inner in value]
    return value
