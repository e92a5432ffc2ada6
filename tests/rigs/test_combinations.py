"""Two or three effects at once each still do what they say."""

import numpy as np
import pytest

from tests.rigs.test_hidden import needed_torque, wave
from workbench.rigs import PERFECT, HiddenEffect, VirtualLeg

COULOMB = HiddenEffect("coulomb_friction", "hip", parameters={"torque": 0.25})
PLAY = HiddenEffect("backlash", "knee", parameters={"gap": 0.01, "stiffness": 500.0})
DAHL = HiddenEffect("presliding_hysteresis", "knee", "joint", {"torque": 0.1, "stiffness": 10.0})
OFFSET = HiddenEffect("encoder_offset", "hip", parameters={"angle": 0.04})
DELAY = HiddenEffect("command_delay", parameters={"time": 1e-3})
BASE = HiddenEffect("base_compliance", parameters={"stiffness": 2e4, "damping": 30.0, "mass": 4.0})

SETS = [
    (COULOMB, OFFSET, DELAY),
    (PLAY, HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.2})),
    (PLAY, COULOMB, HiddenEffect("sensor_delay", parameters={"time": 1.5e-3})),
    (DAHL, BASE, HiddenEffect("encoder_scale", "knee", parameters={"scale": 1.03})),
    (
        HiddenEffect("joint_compliance", "hip", parameters={"stiffness": 200.0, "damping": 0.2}),
        HiddenEffect("cogging", "hip", parameters={"torque": 0.2, "order": 8.0, "phase": 0.0}),
        HiddenEffect("payload_mass", parameters={"mass": 0.1}),
    ),
    (
        HiddenEffect("speed_torque_limit", "knee", parameters={"stall_torque": 1.0, "no_load_speed": 5.0}),
        HiddenEffect("current_loop_lag", "knee", parameters={"time_constant": 2e-3}),
        HiddenEffect("thermal_derating", "knee", parameters={"coefficient": 0.3, "time_constant": 0.5}),
    ),
]


@pytest.mark.parametrize("effects", SETS, ids=lambda effects: "+".join(e.effect for e in effects))
def test_a_set_repeats_with_its_seed_and_is_more_than_parts(
    effects: tuple[HiddenEffect, ...],
) -> None:
    def run(hidden: tuple[HiddenEffect, ...], seed: int = 3) -> np.ndarray:
        return VirtualLeg(hidden, seed).run([wave(250)])[0].position

    whole = run(effects)
    assert np.abs(whole - wave(250).reference @ [[1.0, 1.0], [0.0, 1.0]]).max() < 0.5
    np.testing.assert_array_equal(whole, run(effects))
    assert np.abs(whole - run(effects, seed=4)).max() > 0
    quiet = [VirtualLeg(h, sensors=PERFECT).run([wave(250)])[0] for h in (effects, *((e,) for e in effects))]
    for part in quiet[1:]:
        differences = [
            np.abs(quiet[0].signals[s] - part.signals[s]).max() for s in ("position", "torque_measured")
        ]
        assert max(differences) > 1e-4


def test_friction_behind_a_wrong_encoder_and_a_late_command() -> None:
    (recording,) = VirtualLeg([COULOMB, OFFSET, DELAY], sensors=PERFECT).run([wave()])
    command, torque = (recording.signals[s] for s in ("torque_command", "torque_measured"))
    np.testing.assert_array_equal(torque[4:], command[:-4])
    true = recording.with_signals(position=recording.position - [0.04, 0.0])
    lost = torque[:-1] - needed_torque(true)
    speed = 0.5 * (recording.velocity[1:] + recording.velocity[:-1])[:, 0]
    moving = np.abs(speed) > 0.2
    np.testing.assert_allclose(lost[moving, 0] * np.sign(speed[moving]), 0.25, atol=2e-3)


def test_effects_add_up_in_any_order() -> None:
    for effects in SETS:
        runs = [VirtualLeg(e, sensors=PERFECT).run([wave(150)])[0] for e in (effects, effects[::-1])]
        np.testing.assert_allclose(runs[0].position, runs[1].position, atol=1e-9)


def test_frictions_in_one_place_stick_as_one() -> None:
    """Also where one depends on the load, and where hip drive and hip pin are the same place."""
    pair = [COULOMB, HiddenEffect("load_dependent_friction", "hip", "joint", {"torque": 0.05, "ratio": 0.1})]
    whole = HiddenEffect("load_dependent_friction", "hip", parameters={"torque": 0.3, "ratio": 0.1})
    runs = [VirtualLeg(e, sensors=PERFECT).run([wave(300)])[0] for e in (pair, [whole])]
    np.testing.assert_allclose(runs[0].position, runs[1].position, atol=1e-12)
