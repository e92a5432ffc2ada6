"""Motion that nothing drives: which recordings that are, where swings begin, and what their floor holds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.free_motion import INERTIA, LENGTH, MASS, STEP, friction, pendulum, recorded, swing
from workbench.comparison import NoiseModel, compare, is_free
from workbench.comparison.swing_starts import swing_starts
from workbench.comparison.swings import FreeDecay
from workbench.core import Controller, InputError, Recording
from workbench.effects import compile_plant, load_model
from workbench.simulation import Disturbance

PERIOD = 2 * np.pi * np.sqrt(INERTIA / (MASS * 9.81 * LENGTH))  # of small swings [s]


def starts(recording: Recording) -> tuple[np.ndarray, int]:
    return swing_starts(recording, NoiseModel.of([recording]).levels)


def test_free_is_what_no_torque_drives() -> None:
    quiet = recorded(swing(0.5, duration=3.0))
    assert is_free(quiet)
    assert is_free(recorded(swing(0.5, duration=3.0), torque_noise=0.01)), (
        "a current sensor's noise drives nothing"
    )
    pushed = quiet.with_signals(torque_command=0.1 * np.sin(quiet.time)[:, None])
    assert not is_free(pushed)
    assert not is_free(replace(quiet, controller=Controller("pd", "joint", (1.0,), (0.1,))))


def test_an_undriven_swing_says_how_to_state_that(tmp_path: Path) -> None:
    swinging, hanging = (
        replace(recorded(x), controller=Controller()) for x in (swing(0.5, duration=3.0), np.zeros(2000))
    )
    with pytest.raises(
        InputError, match=r'torque_command is zero in every row.*kind = "none" in .controller.'
    ):
        compare(pendulum(tmp_path), [swinging])
    assert np.isnan(compare(pendulum(tmp_path), [hanging]).error)


def test_swings_begin_a_period_apart_where_motion_is_fastest() -> None:
    recording = recorded(swing(0.3, duration=10.0))
    rows, half = starts(recording)
    assert np.diff(rows) * STEP == pytest.approx(PERIOD, rel=0.1)
    assert np.abs(recording.position[rows]).max() < 0.1 * 0.3, "at the bottom"
    assert 3 <= half <= PERIOD / STEP / 8


def test_what_was_held_first_counts_from_its_release() -> None:
    moving = swing(0.8, duration=8.0)
    held = recorded(np.concatenate([np.full(400, moving[0]), moving]))
    rows, _ = starts(held)
    assert 400 < rows[0] < 400 + PERIOD / STEP
    assert starts(recorded(moving))[0][0] < PERIOD / STEP


def test_noise_of_what_hangs_still_is_explained(tmp_path: Path) -> None:
    still = [recorded(np.zeros(2000), seed=k) for k in range(3)]
    assert compare(pendulum(tmp_path), still).consistent


def test_few_rows_are_refused() -> None:
    with pytest.raises(InputError, match="too few for a free motion"):
        starts(recorded(swing(0.8, duration=0.1)))


def test_a_right_model_stays_at_the_noise_however_long_the_run(tmp_path: Path) -> None:
    model = pendulum(tmp_path)
    for duration in (8.0, 24.0):
        found = compare(model, [recorded(swing(1.2, duration=duration), seed=3)])
        assert found.consistent
        assert found.error < 1.2 * found.noise_error
    rubbing = compare(model, [recorded(swing(1.2, friction(viscous=0.02)))])
    assert rubbing.error > 5.0 * rubbing.noise_error
    assert not rubbing.consistent
    assert any("each swing is simulated" in note for note in rubbing.notes)
    assert not any("command is compared" in note for note in rubbing.notes)


def test_a_small_torque_does_what_the_linearised_swings_say(tmp_path: Path) -> None:
    model, recording = pendulum(tmp_path), recorded(swing(0.8, duration=6.0), noise=1e-6)
    replay = FreeDecay([recording], NoiseModel.of([recording]))
    plant, damping = compile_plant(model), 1e-3
    (clean,) = replay.run([model])[0]
    motion = replay.motion(plant, 0, clean)
    push = Disturbance(-damping * motion.velocity[None])
    ((moved, _),) = replay.propagate([replay.loop(plant, 0, motion)], [push])
    file = tmp_path / "damped.xml"
    file.write_text(
        (tmp_path / "pendulum.xml").read_text().replace('type="hinge"', f'type="hinge" damping="{damping}"')
    )
    (damped,) = replay.run([load_model(str(file))])[0]
    assert moved[:, :, 0] == pytest.approx(damped.position - clean.position, abs=0.03 * np.abs(moved).max())
