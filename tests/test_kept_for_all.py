"""The list of tests that `make test` leaves out names tests that there are."""

from __future__ import annotations

from pathlib import Path

from .kept_for_all import EXTRA, SLOW

HERE = Path(__file__).parent


def test_what_is_left_out_is_there() -> None:
    for place in [*EXTRA, *SLOW]:
        file, _, test = place.partition("[")[0].partition("::")
        assert (HERE / file).exists(), place
        assert not test or f"def {test}(" in (HERE / file).read_text(), place
