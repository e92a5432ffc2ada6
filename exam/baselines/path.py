"""Delay, lag and saturation between a command and the measured torque."""

from __future__ import annotations

import math

import numpy as np
from workbench_exam.answers import Named
from workbench_exam.cases import Case


def command_path(case: Case) -> list[Named]:
    """Delay, lag and saturation between the command and the measured torque, where a log has both.

    Each is tried on a grid; named is the best where it leaves less than half the squared error of none.
    """
    named: list[Named] = []
    if any(not {"torque_command", "torque_measured"} <= r.signals.keys() for r in case.recordings):
        return named
    delays = {
        "command_delay": np.arange(1, 13) * case.period / 4,
        "current_loop_lag": np.arange(1, 13) * 1e-3,
    }
    for i, drive in enumerate(case.drives):
        if not case.driven[i]:
            continue
        pairs = [
            (r.signals["torque_command"][:, i], r.signals["torque_measured"][:, i]) for r in case.recordings
        ]
        none = sum(float(np.sum((u - c) ** 2)) for c, u in pairs)
        limit = max(float(np.quantile(np.abs(u), 0.999)) for _, u in pairs)
        tries = {
            ("torque_saturation", limit): sum(np.sum((u - np.clip(c, -limit, limit)) ** 2) for c, u in pairs)
        }
        for effect, sizes in delays.items():
            for size in sizes:
                tries[effect, float(size)] = sum(
                    np.sum((u - _late(c, effect, size / case.period)) ** 2) for c, u in pairs
                )
        (effect, size), least = min(tries.items(), key=lambda item: item[1])
        if least < 0.5 * none:
            name = {
                "command_delay": "time",
                "current_loop_lag": "time_constant",
                "torque_saturation": "limit",
            }[effect]
            place = None if effect == "command_delay" else drive
            named.append(Named(effect, place, {name: (size, math.nan, math.nan)}))
    return [
        each
        for k, each in enumerate(named)
        if each.place is not None or each.effect not in {n.effect for n in named[:k]}
    ]


def _late(command: np.ndarray, effect: str, rows: float) -> np.ndarray:
    """A command (N,) that is held over each row, late by `rows` of them or through a lag of as many."""
    if effect == "command_delay":
        back = math.ceil(rows)
        return np.concatenate([np.full(back, command[0]), command[: len(command) - back]])
    kept, now, out = math.exp(-1.0 / rows), command[0], np.empty_like(command)
    for k, goal in enumerate(command):
        out[k] = now
        now = goal + (now - goal) * kept
    return out
