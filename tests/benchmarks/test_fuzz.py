"""A hundred spoilt files, a few of every kind: each is read rightly, or refused in one line."""

from __future__ import annotations

from pathlib import Path

import pytest
from fuzzing.case import Bench
from fuzzing.commands import through_cli
from fuzzing.kinds import KINDS

_CASES = 5


@pytest.mark.parametrize("name", KINDS)
def test_a_spoilt_file_is_read_rightly_or_refused_in_one_line(name: str, tmp_path: Path) -> None:
    bench = Bench(name, tmp_path)
    assert bench.good().ending == "accepted"
    outcomes = [bench.run(1, number) for number in range(_CASES)]
    assert [o.text for o in outcomes if o.ending == "failed"] == []


def test_what_is_spoilt_is_mostly_noticed(tmp_path: Path) -> None:
    bench = Bench("recording TOML", tmp_path)
    assert sum(bench.run(2, number).ending == "refused" for number in range(20)) > 10


def test_commands_end_in_one_line_too() -> None:
    endings, failures, _ = through_cli(["recording TOML", "CAN configuration", "record"], 3, 1, 9)
    assert endings.total() == 9 and failures == []
