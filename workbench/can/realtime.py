"""Settings of the operating system for a loop that must not be late; refused settings are reported."""

from __future__ import annotations

import gc
import os
from collections.abc import Iterator
from contextlib import contextmanager

_PRIORITY = 20  # of 99: above everything ordinary, below the kernel's own threads


@contextmanager
def realtime(cpu: int | None = None) -> Iterator[list[str]]:
    """Set realtime scheduling, one processor, no garbage collection; yield what was not permitted.

    Args:
        cpu: processor to stay on; None for any.
    """
    refused: list[str] = []
    policy, parameter, allowed = os.sched_getscheduler(0), os.sched_getparam(0), os.sched_getaffinity(0)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(_PRIORITY))
    except OSError as error:
        refused.append(f"realtime scheduling ({error.strerror})")
    if cpu is not None:
        try:
            os.sched_setaffinity(0, {cpu})
        except OSError as error:
            refused.append(f"processor {cpu} ({error.strerror})")
    collecting = gc.isenabled()
    gc.collect()
    gc.freeze()
    gc.disable()
    try:
        yield refused
    finally:
        gc.unfreeze()
        if collecting:
            gc.enable()
        os.sched_setaffinity(0, allowed)
        try:
            os.sched_setscheduler(0, policy, parameter)
        except OSError as error:  # it was allowed to go up, and is not to come down
            refused.append(f"ordinary scheduling ({error.strerror})")
