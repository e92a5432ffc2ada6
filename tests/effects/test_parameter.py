"""What a fit makes of what an effect says of its parameters."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from workbench.effects import Parameter, Parameters, effect_named, load_model
from workbench.effects.setting import FULL_BRAKING
from workbench.effects.wave import wave

LEG = load_model("leg")


def test_a_coefficient_is_what_a_parameter_is_more_than_neutral() -> None:
    both = Parameters(Parameter("gain", "1", lower=0.2, upper=5.0, neutral=1.0), Parameter("bias", "N*m"))
    assert both.to_values(np.array([0.5, 2.0]), {}) == {"gain": 1.5, "bias": 2.0}
    coefficients, shape = both.to_coefficients({"gain": 1.5, "bias": 2.0})
    assert coefficients.tolist() == [0.5, 2.0] and shape == {}
    low, high = both.bounds(LEG, None)
    assert low.tolist() == [-0.8, 0.0] and high.tolist() == [4.0, np.inf]
    assert both.to_values(np.zeros(0), {}) == {}, "none is free"


def test_what_is_not_linear_is_tried_from_all_its_first_values() -> None:
    def few(motions: object, model: object, place: object) -> list[float]:
        return [1.0, 2.0]

    both = Parameters(
        Parameter("size", "N*m"),
        Parameter("begin", "rad", linear=False, starts=few, reach=lambda shape: 0.1 * shape["end"]),
        Parameter("end", "rad", linear=False, starts=few, least=0.25),
    )
    assert both.nonlinear == ("begin", "end")
    tried = both.shapes([], LEG, None)
    assert [(s["begin"], s["end"]) for s in tried] == list(product((1.0, 2.0), repeat=2))
    assert both.reach({"begin": 3.0, "end": -2.0}) == pytest.approx({"begin": -0.2, "end": 1.00001})
    assert both.least({"begin": 3.0, "end": 2.0}).tolist() == [1e-9, 1e-9, 0.25]
    assert Parameters(Parameter("size", "N*m")).shapes([], LEG, None) == [{}]


@pytest.mark.parametrize("phase", [-3.0, -0.5, 0.0, 2.0])
def test_a_wave_is_solved_for_by_sine_and_cosine(phase: float) -> None:
    ripple = Parameters(
        Parameter("size", "N*m"), Parameter("phase", "rad", lower=-np.pi), chart=wave("size", "phase", 2.0)
    )
    (sine, cosine), _ = ripple.to_coefficients({"size": 0.3, "phase": phase})
    q = np.linspace(0.0, 7.0, 50)
    np.testing.assert_allclose(sine * np.sin(q) + cosine * np.cos(q), 0.3 * np.sin(q + phase), atol=1e-12)
    assert ripple.to_values(np.array([sine, cosine]), {}) == pytest.approx({"size": 0.3, "phase": phase})
    assert [b.tolist() for b in ripple.bounds(LEG, None)] == [[-2.0, -2.0], [2.0, 2.0]]


def test_a_shape_says_what_is_settled_of_the_model() -> None:
    line = Parameters(Parameter("stall", "N*m", linear=False), settles=(FULL_BRAKING,))
    assert line.stated(LEG, {"stall": 1.0}) == LEG
    assert line.stated(LEG, {"stall": 1.0, "full_braking": 1.0}).actuators.full_braking is True


def test_a_phase_is_an_angle_on_a_slide_too() -> None:
    ripple = {p.name: p.unit_on("m") for p in effect_named("cogging").parameters}
    assert ripple == {"torque": "N", "order": "rad/m", "phase": "rad"}
    assert {p.name: p.unit_on("m") for p in effect_named("parallel_spring").parameters}["rest"] == "m"
