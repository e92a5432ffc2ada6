"""A loop is searched whole only where what the torque shows explains the log, if it does in any."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from workbench.diagnosis import diagnose
from workbench.effects import load_model


def test_a_loop_in_which_nothing_explains_the_log_is_not_searched(tmp_path: Path) -> None:
    """It took minutes each, where a payload, wrong centres or rotors explain the log in another."""
    machine, model = bench_arm(tmp_path), load_model(bench_arm(tmp_path, "model", fore_centre=0.07))
    logs = [
        logged(machine, tones, seconds=6.0, seed=k, log_s=0.01, loop_s=0.001, positions_alone=True)
        for k, tones in enumerate((SLOW, FAST))
    ]
    said: list[str] = []
    (finding,) = diagnose(model, logs, progress=said.append).findings
    assert finding.parameters["along"].value == pytest.approx(1.3 * 0.07, rel=0.05)
    (asked,) = (text for text in said if "assumptions about how the loop works" in text)
    ways = int(asked.split()[1])
    again = [text for text in said if "another assumption about the loop" in text]
    assert ways > 1 and len(again) < ways - 1, said
