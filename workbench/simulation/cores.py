"""Compiled loops on all cores: they let go of Python's lock, so threads are enough."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

Made = TypeVar("Made")

_cores = os.cpu_count() or 1


def use_cores(count: int) -> None:
    """Use at most this many from now on: for a process that shares the machine with others of its kind."""
    global _cores
    _cores = max(1, count)


def on_all_cores(function: Callable[..., Made], *arguments: Iterable[Any]) -> list[Made]:
    """What ``map(function, *arguments)`` gives, in its order; an exception of any call is raised."""
    with ThreadPoolExecutor(_cores) as pool:
        return list(pool.map(function, *arguments))
