"""What the demo hides is physical, varied, visible in the logs, and the same for the same seed."""

from collections import Counter

import numpy as np
import pytest

from workbench.core import InputError
from workbench.rigs import (
    DEMO_EFFECTS,
    DRAWN_EFFECTS,
    EFFECTS,
    PERFECT,
    HiddenEffect,
    VirtualLeg,
    chirp,
    draw_hidden,
    hidden_effect,
)
from workbench.rigs.draw import magnitude_range
from workbench.rigs.magnitudes import SMALLEST

DRAWS = [draw_hidden(seed) for seed in range(400)]


def test_a_seed_draws_one_effect_and_always_the_same() -> None:
    assert draw_hidden(5) == draw_hidden(5)
    assert {(d.effect, d.axis, d.location) for d in DRAWS} == {s for s in SMALLEST if s[0] in DEMO_EFFECTS}


def test_every_effect_is_about_as_likely() -> None:
    counts = Counter(draw.effect for draw in DRAWS)
    assert len(counts) == 12
    assert min(counts.values()) > 400 / 12 / 2


def test_a_drawing_stays_what_it_was() -> None:
    """The demo's stories and the benchmarks hang on what each seed hides."""
    payload, friction = draw_hidden(0), draw_hidden(2)
    assert payload == HiddenEffect("payload_mass", parameters={"mass": 0.05222384665843165})
    assert (friction.effect, friction.axis, friction.location) == ("stribeck_friction", "knee", "actuator")
    assert friction.parameters["static"] == pytest.approx(0.44988527919318533, rel=1e-12)


def test_more_effects_can_be_drawn_than_the_demo_draws() -> None:
    assert set(DEMO_EFFECTS) < set(DRAWN_EFFECTS) == set(EFFECTS)
    drawn = Counter(draw_hidden(seed, DRAWN_EFFECTS).effect for seed in range(1200))
    assert set(drawn) == set(DRAWN_EFFECTS) and min(drawn.values()) > 1200 / len(DRAWN_EFFECTS) / 2.5
    assert draw_hidden(3, ["backlash"]).effect == "backlash"
    with pytest.raises(InputError, match="'gremlins' is never drawn"):
        draw_hidden(3, ["gremlins"])


def test_draws_are_physical() -> None:
    for draw in DRAWS:
        p = draw.parameters
        positive = [v for k, v in p.items() if k not in ("rest", "torque") or "friction" in draw.effect]
        assert min(positive, default=1.0) > 0.0
        if draw.effect == "stribeck_friction":
            assert p["static"] > p["coulomb"]
    biases = [d.parameters["torque"] for d in DRAWS if d.effect == "torque_bias"]
    gains = [d.parameters["gain"] for d in DRAWS if d.effect == "torque_constant_error"]
    assert min(biases) < 0 < max(biases)
    assert min(gains) < 1 < max(gains)


@pytest.mark.parametrize("place", SMALLEST, ids=lambda p: f"{p[0]}-{p[1]}-{p[2]}")
def test_the_loop_stands_the_largest(place: tuple[str, str | None, str]) -> None:
    """No runaway and no rattling at the drive's limit with the strongest effect that can be drawn."""
    effect = hidden_effect(place, magnitude_range(place)[1])
    (recording,) = VirtualLeg([effect], sensors=PERFECT).run([chirp("knee", f_max=5.0, duration=1.0)])
    assert np.abs(recording.velocity).max() < 10.0
    assert np.abs(recording.signals["torque_measured"]).max() < 23.0


def test_an_effect_can_be_built_by_hand() -> None:
    built = hidden_effect(("coulomb_friction", "knee", "joint"), 0.3)
    assert built == HiddenEffect("coulomb_friction", "knee", "joint", {"torque": 0.3})
