"""The diagnosis against MuJoCo's own system identification; only where that is installed."""

from __future__ import annotations

import importlib

from side_by_side import spread

from .row import Part, Row


def measure(quick: bool) -> list[Row]:
    """One hidden effect that the toolbox's structure has, and one that it has not.

    Raises:
        ImportError: the toolbox is not installed.
    """
    importlib.import_module("mujoco.sysid")
    import against_sysid as beside

    beside.warm_up(0)
    rows = []
    for title, hidden in beside.CASES.items():
        found = [beside.measured(hidden, seed) for seed in range(1 if quick else 3)]
        rows += [
            Row(
                f"error on held-out motion, {title}",
                "mujoco.sysid",
                str(spread([f.diagnosed / f.fitted for f in found])),
            ),
            Row("CPU time", "mujoco.sysid", str(spread([f.ours.cpu / f.theirs.cpu for f in found]))),
        ]
    return rows


PART = Part(
    "sysid",
    "The diagnosis against MuJoCo's system identification",
    "The toolbox is given one structure of six parameters, the diagnosis ranks its whole catalogue; five "
    "recordings of 53 s for fitting, a sixth for judging. It needs `pip install 'mujoco[sysid]'`.",
    measure,
    "python benchmarks/against_sysid.py",
)
