"""Encoders that wrap are made whole, whatever their range; what only looks like a wrap is left as it is."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.recordings.wrap import RANGES, RAW_RANGES, unwrap, unwrapped, wrap_of

T = np.arange(4000) * 0.002
ROLLS = 6.0 * np.sin(1.3 * T) + 3.0 * T  # a wheel that rolls here and there
SWINGS = 0.7 * np.sin(2.0 * T) + 0.2 * np.sin(7.1 * T)  # a joint about nil


def wrapped(x: np.ndarray, low: float, size: float) -> np.ndarray:
    return (x - low) % size + low


@pytest.mark.parametrize("step", [0.0, 2 * np.pi / 4096])
@pytest.mark.parametrize(
    ("x", "low", "size"),
    [
        (SWINGS, 0.0, 2 * np.pi),
        (ROLLS, -np.pi, 2 * np.pi),
        (4 * ROLLS, -12.5, 25.0),
        (4 * ROLLS, -4 * np.pi, 8 * np.pi),
        (4 * ROLLS, 0.0, 2 * np.pi),
        (ROLLS, -1.1, 2.2),  # behind a gear
    ],
)
def test_jumps_of_a_whole_range_are_undone(x: np.ndarray, low: float, size: float, step: float) -> None:
    seen = np.round(x / step) * step if step else x
    broken = wrapped(seen, low, size)
    wrap = wrap_of(broken)
    assert wrap is not None and wrap.range == pytest.approx(size, rel=2e-3)
    whole = unwrapped(broken, wrap)
    assert np.ptp(whole - seen) < 0.01 * size * np.sqrt(len(wrap.rows))


@pytest.mark.parametrize(
    ("unit", "size"), [(180 / np.pi, 360.0), (1 / (2 * np.pi), 1.0), (2**14 / (2 * np.pi), 2**14)]
)
def test_ranges_in_other_units(unit: float, size: float) -> None:
    wrap = wrap_of(wrapped(unit * ROLLS, 0.0, size), RAW_RANGES)
    assert wrap is not None and wrap.range == size


@pytest.mark.parametrize(
    "x",
    [
        SWINGS,
        ROLLS,
        np.where(np.sin(3 * T) > 0, np.pi, -np.pi),  # a switch
        np.where((T > 3) & (T < 3.01), 0.0, 2.0 + SWINGS),  # lost packets read as nil
        np.where(T > 4, SWINGS + 5.0, SWINGS),  # a homing
        np.zeros(4000),
        np.clip(4 * SWINGS, -0.5, 0.5),
    ],
)
def test_what_is_no_wrap_stays(x: np.ndarray) -> None:
    assert wrap_of(x) is None


def test_a_position_comes_to_the_turn_of_its_reference() -> None:
    signals = {
        "position": wrapped(SWINGS - 0.3, 0.0, 2 * np.pi)[:, None],
        "position_reference": SWINGS[:, None],
    }
    done, (note,) = unwrap(signals, np.ones(len(T), bool), ["hip"], [True])
    np.testing.assert_allclose(done["position"][:, 0], SWINGS - 0.3, atol=1e-9)
    assert "'hip' jumps by its whole range of 6.283 rad" in note and "undone" in note


def test_whole_turns_beside_its_reference_without_a_jump() -> None:
    signals = {"position": SWINGS[:, None] + 2 * np.pi, "position_reference": SWINGS[:, None]}
    done, (note,) = unwrap(signals, np.ones(len(T), bool), ["hip"], [True])
    np.testing.assert_allclose(done["position"][:, 0], SWINGS, atol=1e-9)
    assert "whole turns away" in note


def test_a_reference_that_wraps_and_one_never_followed() -> None:
    good = np.ones(len(T), bool)
    both = {
        name: wrapped(ROLLS + o, -np.pi, 2 * np.pi)[:, None]
        for name, o in (("position", 0.0), ("position_reference", 0.2))
    }
    done, _ = unwrap(both, good, ["wheel"], [True])
    np.testing.assert_allclose(done["position_reference"] - done["position"], 0.2, atol=1e-9)
    off = {"position": SWINGS[:, None], "position_reference": np.full((len(T), 1), 5.0)}
    left, notes = unwrap(off, good, ["hip"], [True])
    assert notes == () and left["position"] is off["position"]


def test_known_ranges_are_told_apart() -> None:
    assert {25.0, 8 * np.pi} <= set(RANGES)
    assert wrap_of(wrapped(4 * ROLLS, -12.5, 25.0)).range == 25.0  # pyright: ignore[reportOptionalMemberAccess]
