"""The second simulator agrees with the first and with the shipped simulation, and keeps time as logs do."""

from dataclasses import replace

import numpy as np
import pytest
from exam.second.bodies import structure
from exam.second.hidden import Hidden
from exam.second.leg import SILENT, Noise, SecondLeg
from exam.second.motions import RANGE, Motion, motions
from exam.second.shapes import Draw, hidden_of
from exam.second.sizes import OUTSIDERS, SEATS

from workbench.comparison import compare
from workbench.core import Recording
from workbench.effects import load_model
from workbench.rigs import PERFECT, Experiment, HiddenEffect, VirtualLeg
from workbench.simulation import Run, simulate

_SIGNALS = ("position", "velocity", "torque_measured")
_NOISE = np.array([Noise().angle, Noise().speed, Noise().torque])


def part(motion: Motion, seconds: float = 1.5) -> Motion:
    rows = round(seconds / motion.period)
    return replace(motion, reference=motion.reference[:rows], feedforward=motion.feedforward[:rows])


SHORT = [part(motion) for motion in motions(3)]


def apart(ours: list[Recording], theirs: list[Recording]) -> np.ndarray:
    """Largest difference over the sensors' noise, of the rms of each signal over axes and recordings."""
    squares = [
        [np.mean((a.signals[s] - b.signals[s]) ** 2) for s in _SIGNALS]
        for a, b in zip(ours, theirs, strict=True)
    ]
    return np.sqrt(np.mean(squares, axis=0)) / _NOISE


def by_virtual_leg(hidden: list[Hidden]) -> list[Recording]:
    effects = [HiddenEffect(h.effect, h.axis, h.location, h.parameters) for h in hidden]
    experiments = [Experiment(m.name, m.reference, m.feedforward, m.excitation) for m in SHORT]
    return VirtualLeg(effects, sensors=PERFECT).run(experiments)


def test_the_bodies_have_the_inertia_that_was_identified() -> None:
    leg = structure()
    assert (leg.m11, leg.m12, leg.m22) == pytest.approx((0.03173, 0.005413, 0.00748), abs=1e-6)
    assert (leg.g1, leg.g2) == pytest.approx((1.850411, 0.274007), abs=1e-5)
    loaded = structure(payload=0.1)
    assert loaded.g2 - leg.g2 == pytest.approx(0.1 * 9.81 * 0.24)


def test_nothing_hidden_moves_as_the_shipped_model() -> None:
    measured = SecondLeg(noise=SILENT).run(SHORT)
    model = load_model("leg")
    assert np.all(apart(measured, simulate([Run(model, r) for r in measured])) < 1e-3)


@pytest.mark.parametrize(
    "hidden",
    [
        [],
        [Hidden("coulomb_friction", "knee", "actuator", {"torque": 0.3})],
        [
            Hidden("stribeck_friction", "knee", "joint", {"coulomb": 0.2, "static": 0.35, "speed": 0.2}),
            Hidden("load_dependent_friction", "hip", "actuator", {"torque": 0.05, "ratio": 0.1}),
        ],
        [
            Hidden(
                "asymmetric_friction",
                "hip",
                "actuator",
                {
                    "damping_positive": 0.02,
                    "damping_negative": 0.01,
                    "torque_positive": 0.3,
                    "torque_negative": 0.1,
                },
            )
        ],
        [
            Hidden("presliding_hysteresis", "hip", "actuator", {"torque": 0.4, "stiffness": 40.0}),
            Hidden("quadratic_drag", "knee", "joint", {"drag": 0.05}),
        ],
        [Hidden("current_loop_lag", axis, "actuator", {"time_constant": 1e-3}) for axis in ("hip", "knee")],
        [
            Hidden("command_delay", None, "actuator", {"time": 4e-4}),
            Hidden("sensor_delay", None, "actuator", {"time": 6e-4}),
        ],
        [
            Hidden("velocity_filter_lag", "knee", "actuator", {"time_constant": 2e-3}),
            Hidden("controller_gain_error", "hip", "actuator", {"kp_scale": 1.1, "kd_scale": 0.9}),
        ],
        [
            Hidden("payload_mass", None, "actuator", {"mass": 0.08}),
            Hidden("reflected_inertia", "hip", "actuator", {"inertia": 0.006}),
        ],
        [
            Hidden("encoder_offset", "hip", "actuator", {"angle": 0.06}),
            Hidden("encoder_scale", "knee", "actuator", {"scale": 1.08}),
        ],
        [
            Hidden("encoder_eccentricity", "hip", "actuator", {"amplitude": 0.06, "phase": 1.0}),
            Hidden("cogging", "knee", "actuator", {"torque": 0.2, "order": 9.0, "phase": 1.0}),
        ],
        [
            Hidden("torque_saturation", "hip", "actuator", {"limit": 1.5}),
            Hidden("speed_torque_limit", "knee", "actuator", {"stall_torque": 2.0, "no_load_speed": 8.0}),
        ],
        [
            Hidden("linkage_inertia", None, "actuator", {"M11": 0.003, "M12": 0.001, "M22": 0.002}),
            Hidden("torque_constant_error", "knee", "actuator", {"gain": 1.1}),
        ],
        [
            Hidden("joint_compliance", "knee", "actuator", {"stiffness": 300.0, "damping": 0.4}),
            Hidden("coulomb_friction", "knee", "actuator", {"torque": 0.2}),
        ],
        [Hidden("backlash", "hip", "actuator", {"gap": 0.005, "stiffness": 400.0, "damping": 1.0})],
    ],
    ids=lambda hidden: "+".join(h.effect for h in hidden) or "clean",
)
def test_both_simulators_agree(hidden: list[Hidden]) -> None:
    measured = SecondLeg(hidden, noise=SILENT).run(SHORT)
    assert np.all(apart(measured, by_virtual_leg(hidden)) < 0.05)
    if hidden:
        assert np.max(apart(measured, SecondLeg(noise=SILENT).run(SHORT))) > 1.0


@pytest.mark.parametrize("effect", OUTSIDERS)
def test_an_outsider_shows(effect: str) -> None:
    seat = next(seat for seat in SEATS if seat[0] == effect)
    strange = SecondLeg([hidden_of(seat, 1.0, Draw())], noise=SILENT).run(SHORT)
    assert np.max(apart(strange, SecondLeg(noise=SILENT).run(SHORT))) > 1.0


def test_rows_are_logged_as_recordings_state() -> None:
    """The loop reads logged rows, holds for a tick, and its torque comes a delay later."""
    recording = SecondLeg(seed=5, noise=replace(Noise(), torque=0.0)).run(SHORT[-1:])[0]
    s = {name: np.array(values) for name, values in recording.signals.items()}
    command, ticks = s["torque_command"], np.arange(0, len(recording), 3)
    q, w, reference = s["position"][ticks], s["velocity"][ticks], s["position_reference"][ticks]
    hip = 50.0 * (reference[:, 0] - q[:, 0]) - 1.5 * w[:, 0]
    knee = 50.0 * (reference[:, 1] - (q[:, 1] - q[:, 0])) - 1.5 * (w[:, 1] - w[:, 0])
    asked = np.column_stack([hip - knee, knee]) + s["torque_feedforward"][ticks]
    np.testing.assert_allclose(command[ticks], asked, atol=1e-12)
    np.testing.assert_array_equal(command, np.repeat(command[ticks], 3, axis=0)[: len(command)])
    assert not s["torque_measured"][:3].any()
    np.testing.assert_array_equal(s["torque_measured"][3:], command[:-3])
    steps = s["position"] / Noise().encoder
    np.testing.assert_allclose(steps, np.rint(steps), atol=1e-6)


def test_a_leg_without_anything_hidden_is_consistent() -> None:
    assert compare(load_model("leg"), SecondLeg(seed=8).run(SHORT), draws=4).consistent


@pytest.mark.parametrize("seed", range(5))
def test_motions_start_at_rest_and_keep_off_the_stops(seed: int) -> None:
    for motion in motions(seed):
        low, high = np.array(RANGE).T
        assert np.all(motion.reference >= low) and np.all(motion.reference <= high)
        assert np.all(np.abs(np.diff(motion.reference[:2], axis=0)) < 1e-3)
        assert motion.reference.shape == motion.feedforward.shape
