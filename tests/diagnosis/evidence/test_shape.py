from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from workbench.diagnosis.evidence.missing_torque import Missing
from workbench.diagnosis.evidence.shape import shapes


def lacking(seed: int = 0) -> Missing:
    """Noise of 0.05 N m along two recordings of two axes that wander."""
    rng = np.random.default_rng(seed)
    count, step = 2400, 0.01
    time = np.tile(np.arange(count // 2) * step, 2)
    phases = rng.uniform(0, 2 * np.pi, (2, 6))
    tones = np.array([0.13, 0.29, 0.47, 0.71, 1.1, 1.7])
    position = np.stack(
        [np.sum(np.sin(2 * np.pi * tones * time[:, None] + p), axis=1) / 3 for p in phases], 1
    )
    speed = np.gradient(position, step, axis=0)
    return Missing(
        torque=rng.normal(0.0, 0.05, (count, 2)),
        position=position,
        speed=speed,
        acceleration=np.gradient(speed, step, axis=0),
        load=position + 0.1 * speed,
        time=time,
        temperature=None,
        start=(0, count // 2),
        step=step,
        axes=("hip", "knee"),
        units=("rad", "rad"),
    )


def with_torque(missing: Missing, torque: np.ndarray) -> Missing:
    """The torque on the knee, beside the noise, each recording's mean taken off."""
    made = missing.torque + np.stack([np.zeros(len(torque)), torque], axis=1)
    parts = np.split(made, missing.start[1:])
    return replace(missing, torque=np.concatenate([p - p.mean(axis=0) for p in parts]))


def test_a_function_of_position_is_followed_whatever_its_form() -> None:
    quiet = lacking()
    q = quiet.position[:, 1]
    found = shapes(with_torque(quiet, np.where(q > 0.2, 2.0 * (q - 0.2), 0.0)), "knee")
    assert (found[0].quantities, found[0].frequency) == (("position",), None) and found[0].share > 0.95
    truth = np.where(found[0].grid > 0.2, 2.0 * (found[0].grid - 0.2), 0.0)
    inside = np.abs(found[0].torque - found[0].torque.mean() - truth + truth.mean())
    assert inside.max() < 0.08
    assert found[0].std.max() < 0.08 and np.nanmax(np.abs(found[0].seen - found[0].torque)) < 0.1


def test_a_torque_between_axes_is_a_function_of_both() -> None:
    quiet = lacking()
    found = shapes(with_torque(quiet, 1.5 * quiet.position[:, 0] * quiet.position[:, 1]), "knee")
    assert found[0].quantities == ("position", "the position of hip") and found[0].share > 0.9


def test_friction_of_any_form_is_a_function_of_speed() -> None:
    quiet = lacking()
    found = shapes(with_torque(quiet, -0.4 * np.tanh(quiet.speed[:, 1]) ** 3), "knee")
    assert found[0].quantities == ("speed",) and found[0].share > 0.9


def test_a_tone_is_found_at_its_frequency_whatever_its_phase() -> None:
    quiet = lacking()
    second = np.arange(len(quiet.time)) >= quiet.start[1]
    found = shapes(with_torque(quiet, 0.3 * np.cos(2 * np.pi * 3.7 * quiet.time + 1.9 * second)), "knee")
    assert found[0].frequency == pytest.approx(3.7, abs=0.01) and found[0].share > 0.9
    assert np.ptp(found[0].torque) == pytest.approx(0.6, rel=0.05)


@pytest.mark.parametrize("seed", range(8))
def test_noise_follows_nothing(seed: int) -> None:
    assert all(s.share < 0.03 for s in shapes(lacking(seed), "knee"))


def test_an_axis_that_is_held_has_no_function_of_its_position() -> None:
    held = lacking()
    held = replace(held, position=held.position * [1.0, 0.0], speed=held.speed * [1.0, 0.0])
    assert all("position" not in s.quantities for s in shapes(held, "knee"))
