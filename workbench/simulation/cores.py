"""Compiled loops on all cores; they release Python's lock, so threads are enough."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any, TypeVar

from threadpoolctl import ThreadpoolController

Made = TypeVar("Made")

_cores = os.cpu_count() or 1


def use_cores(count: int) -> None:
    """Use at most this many cores from now on, for a process that shares the machine with its kind."""
    global _cores
    _cores = max(1, count)


def on_all_cores(function: Callable[..., Made], *arguments: Iterable[Any]) -> list[Made]:
    """Return the results of ``map(function, *arguments)`` in order; an exception of any call is raised.

    Linear algebra keeps to one thread a call meanwhile: its own threads would only wait for these.
    """
    with _linear_algebra().limit(limits=1, user_api="blas"), ThreadPoolExecutor(_cores) as pool:
        return list(pool.map(function, *arguments))


@cache
def _linear_algebra() -> ThreadpoolController:
    return ThreadpoolController()
