"""What is explained: the excess over a perfect model, to whose runs no one can come nearer."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from workbench.diagnosis.loss import explained, median_explained
from workbench.diagnosis.search import ask
from workbench.effects import load_model


def test_what_two_right_simulations_differ_by_is_not_asked_for(tmp_path: Path) -> None:
    machine = bench_arm(tmp_path)
    logs = [logged(machine, tones, seconds=4.0, seed=k) for k, tones in enumerate((SLOW, FAST))]
    problem = ask(load_model(bench_arm(tmp_path, "model", lift_damping=1.6)), logs).problem
    data, start = problem.data, problem.start
    data = replace(data, immaterial=0.2 * start.mean_squares)
    for share_left, removed in ((1.0, 0.0), (0.6, 0.5), (0.2, 1.0), (0.1, 1.0)):
        left = replace(start, mean_squares=data.floor + share_left * (start.mean_squares - data.floor))
        for told in (explained, median_explained):
            assert told(data, start, left, data) == pytest.approx(removed, abs=0.1), (told, share_left)
    assert np.all(data.least() >= data.pool(data.floor))
