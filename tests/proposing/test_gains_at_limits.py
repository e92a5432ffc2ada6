"""The loop's gains, read from a log in which the command stood at its limit now and then."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.proposing.make import KD, KP, columns, imported, log, text


@pytest.mark.parametrize("sides", [1, 2])
def test_a_few_rows_at_a_limit_leave_the_gains_as_they_are(sides: int, tmp_path: Path) -> None:
    """Three rows in a thousand of a clipped command pulled kp by a tenth of a percent."""
    whole = log(3000)
    size = np.abs(whole.cmd[:, 0]) if sides == 2 else whole.cmd[:, 0]
    limit = float(np.sort(size)[-10])
    cmd = whole.cmd.copy()
    cmd[:, 0] = np.clip(cmd[:, 0], -limit if sides == 2 else -np.inf, limit)
    assert 2 < np.sum(cmd[:, 0] != whole.cmd[:, 0]) < 10
    (tmp_path / "run.csv").write_text(text(columns(replace(whole, cmd=cmd, tau=cmd + whole.tau - whole.cmd))))
    controller = imported(tmp_path / "run.csv")[0].description["controller"]
    assert controller["kp"] == pytest.approx(KP, rel=1e-4)
    assert controller["kd"] == pytest.approx(KD, rel=1e-4)
