"""The experiments in which a hidden effect of the virtual leg can show."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from types import MappingProxyType

from workbench.rigs import Experiment, demo_experiments, work_and_rest

#: Effects that the demo's experiments cannot show, and what can: no drive warms up within 15 s.
NEEDS: Mapping[str, Callable[[], Experiment]] = MappingProxyType({"thermal_derating": work_and_rest})


def experiments_for(effects: Collection[str], seed: int = 0) -> tuple[Experiment, ...]:
    """Return the experiments of the demo, and those without which one of these effects would not show.

    Args:
        effects: names of what is hidden.
        seed: draws the validation motion, which stays last.
    """
    *others, judge = demo_experiments(seed)
    return (*others, *(NEEDS[name]() for name in sorted({*effects} & {*NEEDS})), judge)
