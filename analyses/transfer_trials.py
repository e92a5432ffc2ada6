"""Trials that know nothing of each other, on all cores."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

Task = TypeVar("Task")
Result = TypeVar("Result")


def run_trials(
    function: Callable[[Task], Result], tasks: Sequence[Task], serial: bool = False
) -> list[Result]:
    """What ``map(function, tasks)`` gives, in its order, by a process a core.

    Threads would wait for each other: Drake and a diagnosis hold Python's lock most of the time.

    Args:
        function: at the top of a module.
        tasks: what it gets, one at a time.
        serial: one after the other, in this process.
    """
    cores = os.cpu_count() or 1
    if serial or cores == 1 or len(tasks) == 1:
        return [function(task) for task in tasks]
    with ProcessPoolExecutor(cores, mp_context=multiprocessing.get_context("spawn")) as pool:
        return list(pool.map(function, tasks))
