"""Test whether this computer, these buses and this policy are fast enough, before anything moves."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from workbench.can import CanConfig

from .controller import Controller
from .host import Host
from .policies import PolicyController
from .processors import Crowd
from .statistics import Punctuality

REHEARSAL_S = 1.0  # of exchanges with drives that are still disabled
_CALLS = 50
_ANSWERS = 0.85  # of a period: when an exchange is given up
_MISSED = 0.01  # of the ticks


def budget(
    host: Host, config: CanConfig, controller: Controller, say: Callable[[str], None],
    refused: Sequence[str] = (), crowd: Crowd | None = None,
) -> list[str]:  # fmt: skip
    """Rehearse with disabled drives; report and return the time budgets that are exceeded.

    What is counted here is not counted in the run. What the operating system `refused` is lacking too, and
    processors that a `crowd` of others wants: a rehearsal cannot see what a busy machine does a few times a
    minute.
    """
    loop, spent = config.loop, 0.0
    if isinstance(controller, PolicyController):
        spent = takes(controller.rehearse, config.clock.machine)
    host.run(3 * loop.period_s)  # the first tick has nothing to send
    host.count_anew()
    host.run(REHEARSAL_S, lambda each, _: each.operator.stop)
    lacks = [f"not permitted: {what}" for what in refused]
    lacks += crowd.lacking() if crowd else []
    lacks += lacking(host.count_anew(), loop.period_s, 3 * loop.period_s, spent)
    for line in lacks:
        say(f"not enough time: {line}")
    return lacks


def takes(act: Callable[[], object], machine: Callable[[float], float] = lambda seconds: seconds) -> float:
    """Return the time of a policy in all but one of a hundred calls, on the clock of the loop [s]."""
    spent = []
    for _ in range(_CALLS):
        begin = time.perf_counter()
        act()
        spent.append(time.perf_counter() - begin)
    return float(np.percentile(spent, 99)) / machine(1.0)


def lacking(seen: Punctuality, period: float, stale: float, policy: float = 0.0) -> list[str]:
    """Return a line for each exceeded time budget; empty if there is none.

    Args:
        seen: in the rehearsal.
        period: of the loop [s].
        stale: age at which feedback damps [s].
        policy: what it takes [s].
    """
    found = []
    trip, late = seen.percentile(99), max(seen.late, default=0.0)
    if not trip + policy <= _ANSWERS * period:
        of = f" and the policy {1e3 * policy:.2g} ms" if policy else ""
        found.append(
            f"an exchange takes {1e3 * trip:.2g} ms{of} (99 %), of the {1e3 * _ANSWERS * period:.3g} ms "
            "available: use more buses, a longer period or a smaller policy"
        )
    if late + period > stale - period:
        found.append(
            f"the machine was late by {1e3 * late:.2g} ms, and {1e3 * (stale - 2 * period):.2g} ms "
            "remain before feedback is too old: free a processor (--cpu), permit realtime scheduling"
        )
    if seen.missed > _MISSED:
        found.append(
            f"{100 * seen.missed:.2g} % of the ticks began late or not at all: free a processor (--cpu), "
            "permit realtime scheduling"
        )
    if seen.incomplete:
        found.append(
            f"{seen.incomplete} of {seen.ticks} exchanges had no answer: check wiring, termination, bit "
            "rate, and other programs on the processors"
        )
    return found
