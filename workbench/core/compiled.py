"""Functions compiled to machine code, kept on disk in a folder named by a hash of all their files.

numba keeps the code of a caller and does not see that a function of another file, which is part of it, has
changed. After such a change the folder is another one.
"""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numba
from numba.core import config

_PACKAGE = Path(__file__).resolve().parents[1]
_WHERE = ("effects", "simulation")  # folders with compiled functions
_OLD = 7 * 86400.0  # s after which a folder of other code goes


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Compile a function with these options of numba's `njit`, and keep the code."""

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        with kept():
            return numba.njit(cache=True, **options)(function)

    return decorate


@contextmanager
def kept() -> Iterator[None]:
    """Return the folder where numba keeps the code of functions declared here."""
    before, config.CACHE_DIR = config.CACHE_DIR, str(folder())
    try:
        yield
    finally:
        config.CACHE_DIR = before


@cache
def folder() -> Path:
    """Return the folder of the current code; code of other versions is deleted after a week."""
    digest = sha256()
    for file in sorted(f for name in _WHERE for f in (_PACKAGE / name).rglob("*.py")):
        text = file.read_bytes()
        if b"compiled(" in text or b"@law" in text:
            digest.update(text)
    own = _PACKAGE / "__pycache__"
    if not os.access(_PACKAGE, os.W_OK):  # installed for everybody
        own = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "workbench"
    here = own / f"numba-{digest.hexdigest()[:16]}"
    if not here.is_dir():
        here.mkdir(parents=True, exist_ok=True)
        for other in own.glob("numba-*"):
            if time.time() - other.stat().st_mtime > _OLD:
                shutil.rmtree(other, ignore_errors=True)
    return here
