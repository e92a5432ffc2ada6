"""A delay of the whole machine is told from numbers that are wrong on each axis, without screening."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from workbench.diagnosis.screening.one_delay import one_delay_may_suffice
from workbench.diagnosis.search import ask
from workbench.effects import load_model


@pytest.mark.parametrize(("late", "damping", "alone"), [(3, 0.8, True), (0, 1.6, False), (3, 1.6, False)])
def test_a_delay_alone_suffices_where_it_is_alone(
    tmp_path: Path, late: int, damping: float, alone: bool
) -> None:
    machine = bench_arm(tmp_path)
    logs = [logged(machine, t, seconds=4.0, late=late, seed=k) for k, t in enumerate((SLOW, FAST))]
    model = load_model(bench_arm(tmp_path, "model", lift_damping=damping))
    problem = ask(model, logs).problem
    assert problem.inverse_dynamics is not None
    along = problem.inverse_dynamics[2].linearisation
    assert one_delay_may_suffice(problem.start, problem.data, along) is alone
