"""Tensors that PyTorch saved, read by its own reader of weights, which runs nothing that is in the file."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core import InputError
from workbench.core.bounds import MOST_BYTES, too_large

from ..table import Table
from .arrays import stacked

_SAVE = "save the numbers as .npz or .csv: numpy.savez('run.npz', **{k: v.numpy() for k, v in data.items()})"


def read_torch_file(path: Path) -> Table:
    """Return every tensor of numbers with one or two dimensions, by its name in the file.

    Raises:
        InputError: PyTorch is not installed, or the file holds more than tensors, numbers and text.
    """
    try:
        import torch
    except ImportError as error:
        remedy = f"pip install torch, or {_SAVE}"
        raise InputError(
            "is a PyTorch file, and PyTorch is not installed", file=path, remedy=remedy
        ) from error
    try:
        with zipfile.ZipFile(path) as archive:
            if sum(entry.file_size for entry in archive.infolist()) > MOST_BYTES:
                raise too_large(path)
        content = torch.load(path, map_location="cpu", weights_only=True)
    except InputError:
        raise
    except MemoryError:
        raise
    except Exception as error:  # its reader raises whatever the file made it meet
        problem = "holds more than tensors, and reading that could run code"
        raise InputError(problem, file=path, remedy=_SAVE) from error
    found = dict(_arrays("", content, torch))
    left = tuple(name for name, array in found.items() if array is None)
    return stacked(path, {n: a for n, a in found.items() if a is not None}, plain=False, left=left)


def _arrays(name: str, value: Any, torch: Any) -> Iterator[tuple[str, np.ndarray | None]]:
    """Names and arrays; None where it is none with one or two dimensions, besides those of size one."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _arrays(f"{name}.{key}".lstrip("."), item, torch)
        return
    if isinstance(value, torch.Tensor) and value.layout == torch.strided and not value.is_complex():
        array = value.detach().to(torch.float64).numpy()
        if (array.squeeze() if array.ndim > 2 else array).ndim in (1, 2):
            yield name or "column", array.squeeze() if array.ndim > 2 else array
            return
    yield name or "its content", None
