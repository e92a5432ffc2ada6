"""The list of tests that `make test` leaves out names tests that there are, and all that need those."""

from __future__ import annotations

import re
from pathlib import Path

from .kept_for_all import EXTRA, SLOW

HERE = Path(__file__).parent


def test_what_is_left_out_is_there() -> None:
    for place in [*EXTRA, *SLOW]:
        file, _, test = place.partition("[")[0].partition("::")
        assert (HERE / file).exists(), place
        assert not test or f"def {test}(" in (HERE / file).read_text(), place


def test_what_stays_imports_nothing_of_what_is_left_out() -> None:
    """Where the extra is missing, its import would end the whole run before the first test."""
    left_out = [place for place in EXTRA if (HERE / place).exists()]
    folders = "|".join(place for place in left_out if (HERE / place).is_dir())
    taken = re.compile(rf"^(?:from|import) (?:tests\.|\.+)(?:{folders})\b", re.MULTILINE)
    stays = [file for file in HERE.rglob("*.py") if not any(file.is_relative_to(HERE / p) for p in left_out)]
    assert stays and not [str(file) for file in stays if taken.search(file.read_text())]
