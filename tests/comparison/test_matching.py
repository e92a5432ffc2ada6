"""Of what a log of positions alone leaves open, the run of the model decides where the torque does not."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.bench_arm import bench_arm, logged
from workbench.comparison import compare, matched_ways
from workbench.comparison.unlogged import readings
from workbench.effects import load_model

#: Along one tone acceleration goes with position, so that a speed half a tick late is a stiffness.
ONE_TONE = [(0.2, 0.25, 0.0)], [(0.2, 0.2, 1.0)], [(0.2, 0.3, 2.0)]


@pytest.mark.parametrize(("log_s", "loop_s", "held"), [(0.01, 0.002, False), (0.02, 0.004, True)])
def test_a_right_model_tells_what_its_torque_does_not(
    tmp_path: Path, log_s: float, loop_s: float, held: bool
) -> None:
    machine = bench_arm(tmp_path)
    log = logged(machine, ONE_TONE, seconds=4.0, log_s=log_s, loop_s=loop_s, held=held, positions_alone=True)
    model = load_model(machine)
    assert len(readings(model, [log])) > 1
    ((told,),) = matched_ways(model, [log])
    assert (told.timing.reference_held, told.controller.velocity) == (held, "sensor")
    assert sum("fits the recordings" in note for note in told.notes) == 2
    assert compare(model, [log]).consistent


def test_a_wrong_model_leaves_all_and_begins_with_the_nearest(tmp_path: Path) -> None:
    machine, wrong = bench_arm(tmp_path), load_model(bench_arm(tmp_path, "model", lift_armature=0.3))
    log = logged(machine, ONE_TONE, seconds=4.0, log_s=0.01, loop_s=0.002, held=False, positions_alone=True)
    ways = matched_ways(wrong, [log])
    assert len(ways) == len(readings(wrong, [log])) > 1
    errors = [compare(wrong, way).error for way in ways]
    assert errors == sorted(errors)
