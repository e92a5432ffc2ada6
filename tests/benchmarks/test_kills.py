"""Whoever is killed: no motor drives longer than its watchdog, and the log can be read."""

from __future__ import annotations

from pathlib import Path

import pytest
from kills import VICTIMS, kill_once


@pytest.mark.parametrize("which", range(len(VICTIMS)))
def test_whoever_is_killed_leaves_nothing_driven(tmp_path: Path, which: int) -> None:
    victim, how = VICTIMS[which]
    outcome = kill_once(tmp_path, 3.0, victim, how, 1.2 + 0.1 * which)  # it moves since 1.0 s
    assert not outcome.wrong, outcome
    if victim == "host":
        assert outcome.longest > 0.01, "it was the watchdog that stopped them"
