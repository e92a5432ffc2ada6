"""What runs when: `pytest --core` leaves out what needs more than requirements.lock, and what takes long.

Property tests draw the same examples every time, the core fewer; ``HYPOTHESIS_PROFILE=explore`` looks for
new ones.
"""

from __future__ import annotations

import gc
import os
from collections.abc import Iterator, Sequence
from ctypes import CDLL
from pathlib import Path

import pytest
from hypothesis import settings

from .kept_for_all import EXTRA, SLOW

settings.register_profile("same", derandomize=True, deadline=None)
settings.register_profile("core", derandomize=True, deadline=None, max_examples=30)
settings.register_profile("explore", derandomize=False, deadline=None, max_examples=1000, print_blob=True)

_HERE = Path(__file__).parent


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--core", action="store_true", help="only what needs no extra and takes no time")


def pytest_configure(config: pytest.Config) -> None:
    usual = "core" if config.getoption("--core") else "same"
    settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", usual))


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """What is left out as a whole is not even imported: its extra may be missing, and imports take long."""
    place = collection_path.relative_to(_HERE).as_posix() if collection_path.is_relative_to(_HERE) else ""
    return True if config.getoption("--core") and (place in EXTRA or place in SLOW) else None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    for item in items:
        for place in _places(item):
            if place in EXTRA:
                item.add_marker(pytest.mark.extra(EXTRA[place]))
            if place in SLOW:
                item.add_marker(pytest.mark.slow(SLOW[place]))
    if config.getoption("--core"):
        left = [i for i in items if i.get_closest_marker("extra") or i.get_closest_marker("slow")]
        config.hook.pytest_deselected(items=left)
        items[:] = [i for i in items if i not in left]


def pytest_collection_finish() -> None:
    """What was imported stays: no collection of garbage need look through all of it again."""
    gc.freeze()


def _places(item: pytest.Item) -> Iterator[str]:
    """``folder``, ``folder/file.py`` and ``folder/file.py::test`` of a test, without and with parameters."""
    file = item.path.relative_to(_HERE).as_posix()
    parts: Sequence[str] = file.split("/")
    yield from ("/".join(parts[:k]) for k in range(1, len(parts) + 1))
    yield from dict.fromkeys((f"{file}::{item.name.partition('[')[0]}", f"{file}::{item.name}"))


@pytest.fixture(scope="module", autouse=True)
def _free_memory_is_given_back() -> Iterator[None]:
    """A diagnosis frees arrays that glibc keeps, more with each: gigabytes in a worker of many files."""
    yield
    if trim := getattr(CDLL(None), "malloc_trim", None):
        trim(0)
