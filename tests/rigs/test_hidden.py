"""Each hidden effect does what its equation says, seen from outside: in the logs."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from workbench.core import EffectKey, Excitation, InputError, Recording, SimulationError
from workbench.rigs import EFFECTS, OUTSIDERS, PERFECT, Experiment, HiddenEffect, VirtualLeg
from workbench.rigs.experiments import HOLD
from workbench.rigs.hidden import AT_JOINTS

ROWS = 1500

#: Torque on motors 1 and 2 of the nominal leg that holds still at q, and what an effect adds to it.
AT_REST = {
    ("torque_bias", "knee", "actuator"): ({"torque": 0.3}, lambda q, u: [0, -0.3]),
    ("torque_constant_error", "hip", "actuator"): ({"gain": 0.8}, lambda q, u: [0.2 * u[0], 0]),
    ("parallel_spring", "hip", "actuator"): (
        {"stiffness": 2.0, "rest": 0.1},
        lambda q, u: [2 * (q[0] - 0.1), 0],
    ),
    ("parallel_spring", "knee", "joint"): (
        {"stiffness": 2.0, "rest": 0.7},
        lambda q, u: 2 * (q[1] - q[0] - 0.7) * np.array([-1, 1]),
    ),
    ("cubic_spring", "knee", "actuator"): ({"stiffness": 9.0, "rest": 0.0}, lambda q, u: [0, 9 * q[1] ** 3]),
    ("payload_mass", None, "actuator"): (
        {"mass": 0.2},
        lambda q, u: 0.2 * 9.81 * np.array([0.175 * np.sin(q[0]), 0.24 * np.sin(q[1])]),
    ),
    ("linkage_gravity", None, "actuator"): (
        {"g1": 0.3, "g2": 0.1},
        lambda q, u: [0.3 * np.sin(q[0]), 0.1 * np.sin(q[1])],
    ),
    ("encoder_offset", "hip", "actuator"): (
        {"angle": 0.1},
        lambda q, u: [1.850411 * (np.sin(q[0] - 0.1) - np.sin(q[0])), 0],
    ),
    ("link_length_error", "hip", "actuator"): (
        {"length": 0.02},
        lambda q, u: [0.23 * 9.81 * 0.02 * np.sin(q[0]), 0],
    ),
    ("cogging", "hip", "actuator"): (
        {"torque": 0.4, "order": 6.0, "phase": 0.3},
        lambda q, u: [-0.4 * np.sin(6 * q[0] + 0.3), 0],
    ),
}

#: Effects that resist motion.
RESISTANCES = {
    "viscous_damping": {"damping": 0.3},
    "coulomb_friction": {"torque": 0.4},
    "stribeck_friction": {"coulomb": 0.3, "static": 0.5, "speed": 0.2},
    "asymmetric_friction": {
        "damping_positive": 0.05,
        "damping_negative": 0.1,
        "torque_positive": 0.3,
        "torque_negative": 0.5,
    },
    "load_dependent_friction": {"torque": 0.1, "ratio": 0.2},
    "quadratic_drag": {"drag": 0.1},
    "position_dependent_friction": {"torque": 0.3, "order": 10.0, "phase": 0.0},
}


def wave(rows: int = ROWS, amplitude: float = 0.15, frequency: float = 2.0) -> Experiment:
    t = np.arange(rows) * 1e-3
    motion = amplitude * np.sin(2 * np.pi * frequency * t)
    reference = HOLD + np.column_stack([motion, -0.7 * motion])
    return Experiment("wave", reference, np.zeros((rows, 2)), Excitation("reference"))


def still(rows: int = ROWS) -> Experiment:
    return Experiment("still", np.tile(HOLD, (rows, 1)), np.zeros((rows, 2)), Excitation("hold"))


def log(hidden: Sequence[HiddenEffect], experiment: Experiment) -> Recording:
    return VirtualLeg(hidden, seed=3, sensors=PERFECT).run([experiment])[0]


def needed_torque(recording: Recording) -> np.ndarray:
    """Motor torque that the nominal leg needs for a logged motion (N, 2), by differences of the log."""
    q, v = recording.position, recording.velocity
    # true torque is constant over a row: mean acceleration over the row belongs to it
    a, q, v = np.diff(v, axis=0) / 1e-3, 0.5 * (q[1:] + q[:-1]), 0.5 * (v[1:] + v[:-1])
    coupling, curl = (0.005413 * f(q[:, 1] - q[:, 0]) for f in (np.cos, np.sin))
    return (
        np.column_stack(
            [
                0.04793 * a[:, 0] + coupling * a[:, 1] - curl * v[:, 1] ** 2 + 1.850411 * np.sin(q[:, 0]),
                coupling * a[:, 0] + 0.02368 * a[:, 1] + curl * v[:, 0] ** 2 + 0.274007 * np.sin(q[:, 1]),
            ]
        )
        + 0.0972 * v
    )


def lost_torque(hidden: HiddenEffect, experiment: Experiment) -> tuple[np.ndarray, np.ndarray]:
    """Torque (N, 2) that an effect takes away, and the speed (N, 2) at mid-row."""
    recording = log([hidden], experiment)
    speed = 0.5 * (recording.velocity[1:] + recording.velocity[:-1])
    return recording.signals["torque_measured"][:-1] - needed_torque(recording), speed


def test_the_nominal_leg_loses_nothing() -> None:
    recording = log([], wave())
    lost = recording.signals["torque_measured"][:-1] - needed_torque(recording)
    assert np.abs(lost).max() < 1e-4


@pytest.mark.parametrize("place", AT_REST, ids=lambda place: f"{place[0]}-{place[1]}-{place[2]}")
def test_holding_torque(place: tuple[str, str | None, str]) -> None:
    effect, axis, location = place
    parameters, added = AT_REST[place]
    recording = log([HiddenEffect(effect, axis, location, parameters)], still())
    q, u = recording.position[-1], recording.signals["torque_measured"][-1]
    gravity = np.array([1.850411 * np.sin(q[0]), 0.274007 * np.sin(q[1])])
    np.testing.assert_allclose(u - gravity, added(q, u), atol=2e-4)


SEATS = [
    (effect, axis, location)
    for effect in RESISTANCES
    for axis, location in (("hip", "actuator"), ("knee", "actuator"), ("knee", "joint"))
    if location == "actuator" or effect in AT_JOINTS
]


@pytest.mark.parametrize(("effect", "axis", "location"), SEATS)
def test_resistance_opposes_motion_where_it_sits_alone(effect: str, axis: str, location: str) -> None:
    lost, speed = lost_torque(HiddenEffect(effect, axis, location, RESISTANCES[effect]), wave())
    direction = {"hip": [1, 0], "knee": [0, 1]}[axis] if location == "actuator" else [-1, 1]
    across = np.array([direction[1], -direction[0]])
    assert np.abs(lost @ across).max() < 2e-3
    along, slip = lost @ direction / np.dot(direction, direction), speed @ direction
    moving = np.abs(slip) > 0.2
    assert np.all(along[moving] * slip[moving] > -1e-3)
    assert np.abs(along[moving]).max() > 0.05


@pytest.mark.parametrize(("axis", "index"), [("hip", 0), ("knee", 1)])
def test_friction_levels_are_recovered(axis: str, index: int) -> None:
    lost, speed = lost_torque(HiddenEffect("coulomb_friction", axis, "actuator", {"torque": 0.25}), wave())
    moving = np.abs(speed[:, index]) > 0.2
    np.testing.assert_allclose(lost[moving, index] * np.sign(speed[moving, index]), 0.25, atol=1e-3)
    uneven = HiddenEffect("asymmetric_friction", axis, "actuator", RESISTANCES["asymmetric_friction"])
    lost, speed = lost_torque(uneven, wave())
    w, u = speed[:, index], lost[:, index]
    np.testing.assert_allclose(u[w > 0.2], 0.3 + 0.05 * w[w > 0.2], atol=2e-3)
    np.testing.assert_allclose(u[w < -0.2], -0.5 + 0.1 * w[w < -0.2], atol=2e-3)


@pytest.mark.parametrize(
    ("effect", "parameters", "level"),
    [
        ("load_dependent_friction", {"torque": 0.1, "ratio": 0.2}, lambda w, u: 0.1 + 0.2 * np.abs(u)),
        ("quadratic_drag", {"drag": 0.1}, lambda w, u: 0.1 * w**2),
    ],
)
def test_resistance_grows_with_load_or_speed(effect: str, parameters: dict, level: Callable) -> None:
    recording = log([HiddenEffect(effect, "knee", "actuator", parameters)], wave())
    torque, speed = recording.signals["torque_measured"][:-1, 1], recording.velocity[:, 1]
    w = 0.5 * (speed[1:] + speed[:-1])
    moving = np.abs(w) > 0.2
    lost = (torque - needed_torque(recording)[:, 1]) * np.sign(w)
    np.testing.assert_allclose(lost[moving], level(w, torque)[moving], atol=2e-3)


def test_stribeck_sticks_longer_than_coulomb() -> None:
    """A slowly rising torque moves the leg when it passes the static limit, not before."""
    rows = 1200
    ramp = np.zeros((rows, 2))
    ramp[:, 1] = np.linspace(0.0, 2.0, rows)
    experiment = Experiment("ramp", np.tile(HOLD, (rows, 1)), ramp, Excitation("hold"))
    started = []
    for static in (0.4, 0.8):
        friction = {"coulomb": 0.4, "static": static, "speed": 0.1}
        lost, speed = lost_torque(HiddenEffect("stribeck_friction", "knee", "actuator", friction), experiment)
        moves = int(np.nonzero(speed[:, 1])[0][0])
        assert np.all(speed[:moves, 1] == 0.0)
        assert lost[:moves, 1].max() == pytest.approx(static, abs=0.02)
        started.append(moves)
    assert started[1] > started[0]


def test_inertia_takes_torque_by_acceleration() -> None:
    for hidden, inertia in (
        (HiddenEffect("reflected_inertia", "knee", "actuator", {"inertia": 0.004}), [[0, 0], [0, 0.004]]),
        (
            HiddenEffect("linkage_inertia", None, "actuator", {"M11": 0.01, "M12": 0.0, "M22": 0.005}),
            [[0.01, 0], [0, 0.005]],
        ),
    ):
        recording = log([hidden], wave())
        lost = recording.signals["torque_measured"][:-1] - needed_torque(recording)
        acceleration = np.diff(recording.velocity, axis=0) / 1e-3
        np.testing.assert_allclose(lost, acceleration @ np.array(inertia), atol=2e-4)


@pytest.mark.parametrize("extra", [0.4e-3, 1e-3, 1.7e-3])
def test_delay_shows_between_command_and_torque(extra: float) -> None:
    recording = log([HiddenEffect("command_delay", parameters={"time": extra})], wave(300))
    late = int(
        np.ceil(3 + extra / 1e-3 - 1e-9)
    )  # a row just after an edge that is yet to come is one row late
    command, torque = recording.signals["torque_command"], recording.signals["torque_measured"]
    np.testing.assert_array_equal(torque[late:], command[:-late])
    np.testing.assert_array_equal(torque[:late], 0.0)


def test_lag_follows_the_command_exponentially() -> None:
    recording = log([HiddenEffect("current_loop_lag", "hip", parameters={"time_constant": 2e-3})], wave(300))
    command, torque = (recording.signals[s][:, 0] for s in ("torque_command", "torque_measured"))
    kept = np.exp(-0.5)
    np.testing.assert_allclose(torque[4:], command[:-4] + (torque[3:-1] - command[:-4]) * kept, atol=1e-12)


def test_a_tone_is_one_line_and_is_not_measured() -> None:
    tone = {"torque": 0.3, "frequency": 10.0, "phase": 0.0}
    recording = log([HiddenEffect("periodic_disturbance", "hip", parameters=tone)], still(2001))
    lost = recording.signals["torque_measured"][:-1, 0] - needed_torque(recording)[:, 0]
    spectrum = np.abs(np.fft.rfft(lost)) / 1000
    assert np.argmax(spectrum) == 20 and spectrum[20] == pytest.approx(0.3, rel=1e-3)


def test_saturation_clips_before_the_sensor() -> None:
    recording = log([HiddenEffect("torque_saturation", "hip", parameters={"limit": 0.8})], wave())
    assert np.abs(recording.signals["torque_measured"][:, 0]).max() == 0.8


def test_effects_add_up() -> None:
    pair = [
        HiddenEffect("coulomb_friction", "knee", "joint", {"torque": 0.1}),
        HiddenEffect("stribeck_friction", "knee", "joint", {"coulomb": 0.2, "static": 0.2, "speed": 0.1}),
    ]
    whole = HiddenEffect("coulomb_friction", "knee", "joint", {"torque": 0.3})
    np.testing.assert_allclose(log(pair, wave(300)).position, log([whole], wave(300)).position, atol=1e-12)


def test_every_effect_is_tried_here() -> None:
    files = [file for file in Path(__file__).parent.glob("test_*.py") if file.name != "test_draw.py"]
    text = "".join(file.read_text() for file in files)
    assert all(f'"{name}"' in text for name in (*EFFECTS, *OUTSIDERS))


def test_a_random_walk_repeats_with_its_seed_and_has_its_size() -> None:
    walk = HiddenEffect("random_walk_torque", "knee", parameters={"torque": 0.2, "time_constant": 0.05})
    recordings = [VirtualLeg([walk], seed, PERFECT).run([still(6000)])[0] for seed in (1, 1, 2)]
    np.testing.assert_array_equal(recordings[0].position, recordings[1].position)
    assert np.abs(recordings[0].position - recordings[2].position).max() > 1e-4
    lost = recordings[0].signals["torque_measured"][:-1] - needed_torque(recordings[0])
    assert lost[:, 1].std() == pytest.approx(0.2, rel=0.2)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("gremlins", "hip", "actuator", {}), "cannot hide 'gremlins'"),
        (("torque_bias", "ankle", "actuator", {"torque": 1.0}), "no such place"),
        (("torque_bias", "hip", "joint", {"torque": 1.0}), "cannot sit in a joint"),
        (("torque_bias", None, "actuator", {"torque": 1.0}), "acts on one axis"),
    ],
)
def test_what_cannot_be_hidden_is_refused(arguments: tuple, said: str) -> None:
    with pytest.raises(InputError, match=said):
        HiddenEffect(*arguments)


@pytest.mark.parametrize(
    ("axis", "location", "called"),
    [("hip", "joint", "actuator"), ("hip", "actuator", "actuator"), ("knee", "joint", "joint")],
)
def test_it_is_called_what_a_finding_would_be(axis: str, location: str, called: str) -> None:
    hidden = HiddenEffect("coulomb_friction", axis, location, {"torque": 0.3})
    assert hidden.key == EffectKey("coulomb_friction", axis, called)


def test_wrong_parameters_and_too_many_frictions_are_refused() -> None:
    with pytest.raises(InputError, match="parameters of 'torque_bias' do not fit"):
        VirtualLeg([HiddenEffect("torque_bias", "hip", parameters={"offset": 1.0})])
    three = [("hip", "actuator"), ("knee", "actuator"), ("knee", "joint")]
    with pytest.raises(SimulationError, match="two pins at most"):
        VirtualLeg([HiddenEffect("coulomb_friction", a, p, {"torque": 0.1}) for a, p in three])
