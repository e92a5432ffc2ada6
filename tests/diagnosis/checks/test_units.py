"""What a wrong unit makes as well is called that first, where nobody stated the unit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.planar_leg import moved, write_leg
from workbench.core import EffectKey, Estimate, Finding, InputError, Recording
from workbench.diagnosis.checks.units import differing_units, doubted, refuse_unit, state_units
from workbench.effects import load_model


def guessed(*kinds: str, motion: float = 1.0, torque: float = 1.0) -> Recording:
    r = moved()
    scaled = {name: motion * r.signals[name] for name in ("position", "velocity", "position_reference")}
    scaled |= {name: torque * r.signals[name] for name in ("torque_command", "torque_measured")}
    return replace(r.with_signals(**scaled), guessed_units=kinds)


@pytest.mark.parametrize(
    ("motion", "torque", "kind", "named"),
    [
        (1 / (2 * np.pi), 1.0, "position", "revolutions and radians"),
        (np.pi / 180, 1.0, "position", "degrees and radians"),
        (1.0, 1000.0, "torque", "milli"),
    ],
)
def test_weight_contradicts_a_guessed_unit(
    tmp_path: Path, motion: float, torque: float, kind: str, named: str
) -> None:
    model = load_model(str(write_leg(tmp_path)))
    wrong = guessed("position", "velocity", "torque", motion=motion, torque=torque)
    with pytest.raises(
        InputError, match=f"possible unit error: `import` guessed the unit of {kind}.*{named}"
    ):
        refuse_unit(model, [wrong])
    refuse_unit(model, [replace(wrong, guessed_units=())])  # a unit that somebody stated is believed
    refuse_unit(model, [guessed("position", "velocity", "torque")])  # a right guess is no news


def finding(gain: float) -> Finding:
    return Finding(
        EffectKey("torque_constant_error", "hip"), {"gain": Estimate(gain, 0.01, "1")}, 0.1, None, None, 0.96,
        evidence=("what it removes",),
    )  # fmt: skip


@pytest.mark.parametrize(("gain", "doubt"), [(0.171, True), (9.8, True), (0.85, False), (1.3, False)])
def test_a_finding_that_is_a_factor_between_units(gain: float, doubt: bool) -> None:
    (found,) = doubted([finding(gain)], [guessed("position", "velocity", "torque")])
    assert found.evidence[0].startswith("possible unit error") == doubt
    assert found.evidence[-1] == "what it removes"
    assert doubted([finding(gain)], [moved()]) == (finding(gain),)


def in_unit(name: str, torque: np.ndarray | float) -> Recording:
    r = moved()
    return replace(r.with_signals(torque_measured=torque * r.signals["torque_measured"]), name=name)


def test_recordings_whose_torque_is_in_another_unit_disagree() -> None:
    (found,) = differing_units([in_unit("monday", 8.8507), in_unit("tuesday", 1.0)])
    assert (found.recordings, found.key.axis, found.meaning) == (
        ("monday", "tuesday"),
        None,
        "in lbf and N m",
    )
    np.testing.assert_allclose(found.values, [8.8507, 1.0], rtol=0.05)
    advice = state_units([found])
    assert advice is not None and "of monday under [units]" in advice  # and not of tuesday, which is right
    assert state_units([replace(found, meaning="")]) is None  # a load or a day is no unit


def test_a_torque_a_hundred_times_too_large_is_in_ncm() -> None:
    (found,) = differing_units([in_unit("monday", 100.0), in_unit("tuesday", 1.0)])
    assert found.meaning == "N cm and N m"


@pytest.mark.parametrize("torque", [8.8507, np.array([1.6, 1.0]), 1.1])
def test_what_is_alike_in_all_or_of_one_axis_is_no_dispute(
    torque: np.ndarray | float,
) -> None:
    others = in_unit("tuesday", torque if torque == pytest.approx(8.8507) else 1.0)
    assert differing_units([in_unit("monday", torque), others]) == ()


def test_an_axis_that_nothing_drives_has_no_say() -> None:
    """As the rod on a cart: its torque is none in any unit."""

    def on_one_axis(name: str, torque: float) -> Recording:
        r = in_unit(name, torque)
        return r.with_signals(**{k: r.signals[k] * [1.0, 0.0] for k in ("torque_command", "torque_measured")})

    (found,) = differing_units([on_one_axis("monday", 0.7376), on_one_axis("tuesday", 1.0)])
    np.testing.assert_allclose(found.values, [0.7376, 1.0], rtol=0.05)
