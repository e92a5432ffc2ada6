"""Displays of the learning curve during training: TensorBoard, Weights & Biases, or none."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

from workbench.core import InputError
from workbench.core.files import saying, write_whole
from workbench.core.packages import need

LOGGERS = ("tensorboard", "wandb", "none")  #: the first is used where none is asked for
_RUN_ID = "wandb.txt"  # in the run's folder: the run that a resumed one goes on with


class Logger(Protocol):
    """Receives the numbers of each iteration by name: ``reward``, ``term/NAME``, ``loss/NAME``."""

    def add(self, iteration: int, values: Mapping[str, float]) -> None:
        """Add the numbers of an iteration."""

    def flush(self) -> None:
        """Make all numbers visible."""

    def close(self) -> None:
        """Close the logger."""


def make_logger(name: str, folder: Path, done: int, config: Mapping[str, Any]) -> Logger:
    """Return the logger of this name.

    Args:
        name: one of `LOGGERS`.
        folder: of the run.
        done: iterations already done, of a run that goes on.
        config: of the run, for loggers that show it.

    Raises:
        InputError: there is none of this name, or its package is missing.
    """
    if name == "tensorboard":
        return _TensorBoard(folder / "tensorboard", done)
    if name == "wandb":
        return _WeightsAndBiases(folder, done, config)
    check_logger(name)
    return _Nowhere()


def check_logger(name: str) -> None:
    """Refuse a logger that cannot be used, before the training starts.

    Raises:
        InputError: there is none of this name, or its package is missing.
    """
    if name not in LOGGERS:
        raise InputError(f"no logger is called '{name}'", remedy=f"choose one of {', '.join(LOGGERS)}")
    if name == "wandb":
        need("wandb", "the logger wandb", "wandb", "wandb")


class _TensorBoard:
    def __init__(self, events: Path, done: int) -> None:
        from torch.utils.tensorboard.writer import SummaryWriter

        self._events = events
        with saying(events):
            self._board = SummaryWriter(str(events), purge_step=done + 1 if done else None)

    def add(self, iteration: int, values: Mapping[str, float]) -> None:
        with saying(self._events):
            for name, value in values.items():
                self._board.add_scalar(name, value, iteration)

    def flush(self) -> None:
        with saying(self._events):
            self._board.flush()

    def close(self) -> None:
        with saying(self._events):
            self._board.close()


class _WeightsAndBiases:
    def __init__(self, folder: Path, done: int, config: Mapping[str, Any]) -> None:
        check_logger("wandb")
        package: Any = import_module("wandb")
        known = folder / _RUN_ID
        again = known.read_text("utf-8").strip() if done and known.is_file() else None
        about = {"project": "workbench", "name": folder.name, "dir": str(folder), "config": dict(config)}
        self._run = package.init(**about, id=again, resume="allow")
        write_whole(known, f"{self._run.id}\n", force=True)

    def add(self, iteration: int, values: Mapping[str, float]) -> None:
        self._run.log(dict(values), step=iteration)

    def flush(self) -> None:
        pass  # the package sends what it has by itself

    def close(self) -> None:
        self._run.finish()


class _Nowhere:
    def add(self, iteration: int, values: Mapping[str, float]) -> None:
        pass

    def flush(self) -> None:
        pass

    def close(self) -> None:
        pass
