"""A log of two joints under a PD loop, and every way in which people write such a log down."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core import Recording
from workbench.proposing import Answers, Proposal, complete, open_table, propose, write
from workbench.recordings import load_recording

KP, KD = np.array([60.0, 30.0]), np.array([2.0, 1.0])


@dataclass(frozen=True)
class Log:
    """SI; all but `t` (N, 2)."""

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    ref: np.ndarray
    cmd: np.ndarray
    tau: np.ndarray


def log(rows: int = 1200, period: float = 0.005, seed: int = 0) -> Log:
    """Two joints that move as no sine does, the position a little behind its reference."""
    rng = np.random.default_rng(seed)
    t = np.arange(rows) * period
    ease = np.clip(t / 0.5, 0, 1) ** 2

    def path(s: np.ndarray) -> np.ndarray:
        return np.column_stack(
            [
                0.6 * np.sin(2.1 * s) + 0.2 * np.sin(7.3 * s),
                0.5 * np.sin(3.3 * s + 0.4) - 0.15 * np.cos(9.1 * s),
            ]
        )

    ref = path(t) * ease[:, None]
    late = np.clip(t - 0.02, 0, None)
    q = path(late) * np.clip(late / 0.5, 0, 1)[:, None] ** 2
    v = np.gradient(q, period, axis=0)
    seen = np.round(q / 1e-4) * 1e-4
    v = v + rng.normal(0, 3e-3, v.shape)
    cmd = KP * (ref - seen) - KD * v
    return Log(t, seen, v, ref, cmd, cmd + rng.normal(0, 0.02, cmd.shape))


def columns(of: Log, **unit: float) -> dict[str, np.ndarray]:
    """Plain columns of a log, each kind divided by a unit's size."""
    u = {"t": 1.0, "q": 1.0, "v": 1.0, "tau": 1.0, **unit}
    out = {"t": of.t / u["t"]}
    for i, joint in enumerate(("hip", "knee")):
        out |= {
            f"pos_{joint}": of.q[:, i] / u["q"],
            f"vel_{joint}": of.v[:, i] / u["v"],
            f"pos_ref_{joint}": of.ref[:, i] / u["q"],
            f"cmd_torque_{joint}": of.cmd[:, i] / u["tau"],
            f"torque_{joint}": of.tau[:, i] / u["tau"],
        }
    return out


def text(data: dict[str, Any], separator: str = ",", decimal: str = ".", header: bool = True) -> str:
    """Columns as text."""
    cells = zip(*(np.asarray(v).tolist() for v in data.values()), strict=True)
    rows = [separator.join(_cell(x, decimal) for x in row) for row in cells]
    return "\n".join([separator.join(data)] * header + rows) + "\n"


def _cell(value: Any, decimal: str) -> str:
    if isinstance(value, str):
        return value
    return "" if value != value else repr(value).replace(".", decimal)


def imported(file: Path, answers: Answers | None = None) -> tuple[Proposal, Recording]:
    """What the wizard makes of a file, written and read again; no question may be open."""
    table = open_table(file)
    proposal = propose(table, answers)
    assert not proposal.questions, proposal.questions
    proposal, _ = complete(proposal, table, answers or Answers())
    target = file.parent / "made" / "run.toml"
    write(proposal, table, target, force=True)
    return proposal, load_recording(target)


def same(recording: Recording, of: Log, *, rows: slice = slice(None), tolerance: float = 1e-3) -> None:
    """The recording is the log, in SI, signal by signal."""
    for signal, truth in (("position", of.q), ("velocity", of.v), ("torque_measured", of.tau)):
        found = recording.signals[signal]
        assert found.shape == truth[rows].shape, signal
        assert np.abs(found - truth[rows]).max() < tolerance * np.ptp(truth), signal


def mixed(of: Log, *, units: bool = True, **named: str) -> dict[str, np.ndarray]:
    """Columns of the same log, its first joint in degrees and its second a slide in millimetres.

    Args:
        of: the log; what is rad and N m there, is m and N for the slide.
        units: whether names state units.
        named: a quantity's unit in the names of the turning axis, where it differs from that of its numbers.
    """
    out = {"Stamp" + " [ms]" * units: of.t * 1e3}
    for i, (axis, size) in enumerate((("A1", np.pi / 180), ("Z", 1e-3))):
        q, v, tau = ("mm", "mm/s", "N") if i else (named.get("q", "deg"), named.get("v", "deg/s"), "Nm")
        for name, values, unit in (
            ("set", of.ref[:, i] / size, q),
            ("act", of.q[:, i] / size, q),
            ("speed", of.v[:, i] / size, v),
            ("drive out", of.cmd[:, i], tau),
            ("drive meas", of.tau[:, i], tau),
        ):
            out[f"{axis} {name}" + f" [{unit}]" * units] = values
    return out


def put(folder: Path, content: str, name: str = "run.csv", encoding: str = "utf-8") -> Path:
    """A file with this text."""
    path = folder / name
    path.write_bytes(content.encode(encoding))
    return path
