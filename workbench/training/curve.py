"""The learning curve: sums of rewards and lengths of episodes, and one row per iteration."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch

from workbench.core.files import write_whole

from .curve_file import FILE, draw, read_curve
from .loggers import Logger
from .situation import POLICY_S


class Tally:
    """Sums of rewards over steps and episodes; a GPU is read only when a row is asked for.

    Args:
        worlds: how many.
        device: of the learner.
    """

    def __init__(self, worlds: int, device: str) -> None:
        self._sums = torch.zeros(worlds, 2, device=device)  # of the running episodes: reward, length [s]
        self._last = torch.zeros(2, device=device)  # of those that ended last: their means
        self._clear()

    def add(self, reward: torch.Tensor, ended: torch.Tensor, terms: Mapping[str, Any]) -> None:
        """Add one step: rewards and ends (W,), and the mean of each term per second."""
        self._rewards.append(reward.mean())
        for name, value in terms.items():
            self._terms.setdefault(name, []).append(torch.as_tensor(value))
        self._sums[:, 0] += reward
        self._sums[:, 1] += POLICY_S
        mark = ended.float()[:, None]
        self._ended = self._ended + (mark * self._sums).sum(dim=0)
        self._count = self._count + mark.sum()
        self._sums *= 1.0 - mark

    def row(self) -> dict[str, float]:
        """Return the sums since the last row."""
        self._last = torch.where(self._count > 0, self._ended / self._count.clamp(min=1.0), self._last)
        out = {
            "reward": float(torch.stack(self._rewards).mean()) / POLICY_S,
            "episode_reward": float(self._last[0]),
            "episode_s": float(self._last[1]),
        }
        out |= {f"term_{name}": float(torch.stack(v).float().mean()) for name, v in self._terms.items()}
        self._clear()
        return out

    def state(self) -> dict[str, torch.Tensor]:
        """Return the state on which the next rows depend."""
        return {"sums": self._sums, "last": self._last}

    def restore(self, state: Mapping[str, torch.Tensor]) -> None:
        """Continue from a `state`."""
        self._sums, self._last = state["sums"].clone(), state["last"].clone()

    def _clear(self) -> None:
        self._rewards: list[torch.Tensor] = []
        self._terms: dict[str, list[torch.Tensor]] = {}
        self._ended = torch.zeros_like(self._last)
        self._count = torch.zeros((), device=self._last.device)


class Curve:
    """One row per iteration, as CSV and for a logger.

    Args:
        folder: of the run.
        done: iterations already done; rows beyond them, of a run that was stopped, are dropped.
        logger: is told every row at once.
    """

    def __init__(self, folder: Path, done: int, logger: Logger) -> None:
        self._file, self._logger = folder / FILE, logger
        self._rows = [row for row in read_curve(folder) if row["iteration"] <= done]

    def add(self, iteration: int, values: Mapping[str, float]) -> None:
        """Add a row; the CSV file contains it after the next `flush`."""
        self._rows.append({"iteration": float(iteration), **values})
        self._logger.add(iteration, {re.sub("^(term|loss)_", r"\1/", name): x for name, x in values.items()})

    def flush(self) -> None:
        """Write the complete CSV file again."""
        stream = io.StringIO()
        writer = csv.DictWriter(stream, list(self._rows[0]), lineterminator="\n", restval="")
        writer.writeheader()
        writer.writerows({k: f"{v:.6g}" for k, v in row.items()} for row in self._rows)
        write_whole(self._file, stream.getvalue(), force=True)
        draw(self._file.with_suffix(".png"), self._rows)
        self._logger.flush()

    def close(self) -> None:
        """Close the loggers."""
        self._logger.close()
