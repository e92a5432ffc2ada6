"""Of what a log of positions alone leaves open, the run of the model decides where the torque does not."""

from __future__ import annotations

from pathlib import Path

from tests.bench_arm import bench_arm, logged
from workbench.comparison import compare, matched_ways
from workbench.comparison.unlogged import readings
from workbench.effects import load_model

#: Along one tone acceleration goes with position, so that a speed half a tick late is a stiffness.
ONE_TONE = [(0.4, 0.5, 0.0)], [(0.3, 0.6, 1.0)], [(0.4, 0.7, 2.0)]


def test_a_right_model_tells_what_its_torque_does_not(tmp_path: Path) -> None:
    machine = bench_arm(tmp_path)
    log = logged(machine, ONE_TONE, seconds=4.0, log_s=0.01, loop_s=0.001, held=False, positions_alone=True)
    model = load_model(machine)
    ways = matched_ways(model, [log])
    assert len(ways) < len(readings(model, [log]))
    for (told,) in ways:
        assert told.timing.reference_held is False
        assert any("explains the recordings" in note for note in told.notes)
        assert compare(model, [told]).consistent


def test_a_wrong_model_leaves_all_that_may_be_and_begins_with_the_nearest(tmp_path: Path) -> None:
    machine, wrong = bench_arm(tmp_path), load_model(bench_arm(tmp_path, "model", lift_armature=0.3))
    log = logged(machine, ONE_TONE, seconds=4.0, log_s=0.01, loop_s=0.001, held=True, positions_alone=True)
    ways = matched_ways(wrong, [log])
    assert len(ways) == len(readings(wrong, [log])) > 1
    errors = [compare(wrong, way).error for way in ways]
    assert errors == sorted(errors)
