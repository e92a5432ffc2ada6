"""What a verdict says beside the names: how much is left."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from workbench.diagnosis import diagnose
from workbench.effects import load_model


def test_at_the_noise_nothing_is_left_unexplained(tmp_path: Path) -> None:
    """Held-out motion shows a rotor 10 % too large as little as a torque of 4 mN m, which is in no other."""
    machine, model = bench_arm(tmp_path), load_model(bench_arm(tmp_path, "model", bend_armature=0.066))
    logs = [logged(machine, tones, seconds=6.0, seed=k) for k, tones in enumerate((SLOW, FAST))]
    held_out = logged(machine, SLOW, seconds=6.0, seed=5, resisting=lambda q, w: np.array([0.0, 0.0, 0.004]))
    found = diagnose(model, logs, [held_out])
    assert [str(f.key) for f in found.findings] == ["reflected_inertia@bend"]
    assert (found.stopped, found.verdict, found.unexplained_fraction) == ("noise", "missing_effect", 0.0)
