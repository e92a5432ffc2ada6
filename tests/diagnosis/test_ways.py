"""A loop is searched whole only where what the torque shows explains the log, if it does in any."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from workbench.diagnosis import diagnose
from workbench.effects import load_model


def test_a_loop_in_which_nothing_explains_is_not_searched(tmp_path: Path) -> None:
    """It took minutes each, where a payload, wrong centres or rotors explain the log in another."""
    machine, model = bench_arm(tmp_path), load_model(bench_arm(tmp_path, "model", fore_centre=0.07))
    logs = [
        logged(machine, tones, seconds=4.0, seed=k, log_s=0.01, loop_s=0.001, positions_alone=True)
        for k, tones in enumerate((SLOW, FAST))
    ]
    said: list[str] = []
    (finding,) = diagnose(model, logs, progress=said.append).findings
    assert finding.parameters["along"].value == pytest.approx(1.3 * 0.07, rel=0.05)
    (asked,) = (text for text in said if "assumptions about how the loop works" in text)
    ways = int(asked.split()[1])
    again = [text for text in said if "another assumption about the loop" in text]
    assert ways > 1 and len(again) < ways - 1, said


def test_a_noisy_speed_that_was_not_logged_leaves_the_simpler(tmp_path: Path) -> None:
    """Two wrong rotors hide which loop it was; by differences of positions a third one would be wrong."""
    machine = bench_arm(tmp_path)
    model = load_model(bench_arm(tmp_path, "model", bend_armature=0.09, lift_armature=0.12))
    logs = [
        logged(
            machine, tones, seconds=3.5, seed=k, log_s=0.01, loop_s=0.002, held=False,
            positions_alone=True, speed_noise=0.03,
        )
        for k, tones in enumerate((SLOW, FAST))
    ]  # fmt: skip
    said: list[str] = []
    found = {
        str(f.key): f.parameters["inertia"].value
        for f in diagnose(model, logs, progress=said.append).findings
    }
    assert found == pytest.approx(
        {"reflected_inertia@bend": -0.03, "reflected_inertia@lift": -0.0332}, rel=0.05
    )
    assert any("assumptions about how the loop works" in text for text in said)
    assert not any("another assumption about the loop" in text for text in said)


def test_a_delay_is_found_under_the_right_loop(tmp_path: Path) -> None:
    """It is no torque along the motion: what the torque shows would have another loop, and more effects."""
    logs = [
        logged(
            bench_arm(tmp_path), tones, seconds=2.0, seed=k, log_s=0.002, loop_s=0.001, held=False,
            positions_alone=True, late=5,
        )
        for k, tones in enumerate((SLOW, FAST))
    ]  # fmt: skip
    said: list[str] = []
    (finding,) = diagnose(load_model(bench_arm(tmp_path)), logs, progress=said.append).findings
    assert finding.key.effect in ("command_delay", "sensor_delay")
    assert finding.parameters["time"].value == pytest.approx(0.005, abs=1e-4)
    assert any("assumptions about how the loop works" in text for text in said)
    assert not any("another assumption about the loop" in text for text in said)


def test_a_delay_beside_damping_is_no_six_wrong_numbers(tmp_path: Path) -> None:
    """With a reference that is constant from row to row, damping and rotors of all axes explain as much."""
    machine, model = bench_arm(tmp_path, lift_damping=1.6), load_model(bench_arm(tmp_path, "model"))
    logs = [
        logged(
            machine, tones, seconds=2.0, seed=3 + k, log_s=0.01, loop_s=0.002, held=False,
            positions_alone=True, late=2,
        )
        for k, tones in enumerate((FAST, SLOW))
    ]  # fmt: skip
    found = {str(f.key): f for f in diagnose(model, logs).findings}
    assert found["command_delay"].parameters["time"].value == pytest.approx(0.004, abs=1e-4)
    damping = found["viscous_damping@lift"]
    assert damping.parameters["damping"].value == pytest.approx(0.8, rel=0.03)
    assert len(found) == 2
    # what did as well while the delay was missing does not beside it
    assert not damping.indistinguishable_from and damping.probability > 0.9
