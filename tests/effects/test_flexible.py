"""Springs in series, gaps, soft stands and longer links: limits, resonances, energy."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from scipy import signal

from tests.effects.cases import experiment, reference
from tests.simulation.make import having, leg_experiment, simulated, slide_experiment
from workbench.core import Controller, EffectKey, InputError
from workbench.effects import EFFECTS, Compliance, build, compile_plant, effect_named, kinds, load_model
from workbench.effects.flexible import spring_wind
from workbench.models import Model, Placement
from workbench.simulation import Track, motion_of, required_torque

LEG, TREE = load_model("leg"), load_model("leg_kin_only")
SPRINGS = [
    (LEG, EffectKey("joint_compliance", "hip")),
    (LEG, EffectKey("joint_compliance", "knee")),
    (LEG, EffectKey("joint_compliance", "knee", "joint")),
    (TREE, EffectKey("joint_compliance", "hip")),
    (TREE, EffectKey("joint_compliance", "knee", "joint")),
]


def test_what_splits_a_joint_needs_the_past() -> None:
    """No sensor shows both sides of a spring: a run cannot begin with it in the middle of a recording."""
    assert all(kinds.has_hidden_state(e) for e in EFFECTS if isinstance(e, Compliance))


@pytest.mark.parametrize(("model", "key"), SPRINGS, ids=lambda x: x.name if isinstance(x, Model) else str(x))
def test_a_stiff_spring_is_a_rigid_drive(model: Model, key: EffectKey) -> None:
    name = "leg" if model is LEG else "leg_kin_only"
    stiff = having(model, key, stiffness=2e5, damping=2.0)
    assert compile_plant(stiff).substeps > 1
    moved = simulated(stiff, experiment(name)).position - reference(name).position
    soft = simulated(having(model, key, stiffness=100.0, damping=0.1), experiment(name))
    far = soft.position - reference(name).position
    assert np.abs(moved).max() < 1e-2 * np.abs(far).max()


def at_the_knee(model: Model, location: str) -> np.ndarray:
    soft = having(model, EffectKey("joint_compliance", "knee", location), stiffness=60.0, damping=0.02)
    return simulated(soft, experiment("leg")).position


def test_a_spring_at_the_knee_is_one_at_its_drive() -> None:
    """Only one drive turns the knee: without a linkage between them it is two words for one machine."""
    drive, pin = (at_the_knee(load_model("leg_s3n_act"), at) for at in ("actuator", "joint"))
    np.testing.assert_allclose(pin, drive, atol=1e-8)


def test_crank_and_coupler_are_ahead_of_a_spring_at_the_knee() -> None:
    drive, pin = (at_the_knee(LEG, at) for at in ("actuator", "joint"))
    assert 1e-3 < np.abs(pin - drive).max() < 1e-2


def test_backlash_without_a_gap_is_a_spring() -> None:
    spring = having(LEG, EffectKey("joint_compliance", "hip"), stiffness=300.0, damping=0.0)
    tight = having(LEG, EffectKey("backlash", "hip"), gap=0.0, stiffness=300.0)
    first, second = simulated(spring, experiment("leg")), simulated(tight, experiment("leg"))
    np.testing.assert_array_equal(first.position, second.position)


def test_damped_flanks_without_a_gap_are_a_damped_spring() -> None:
    damped = replace(LEG, flank_retardation_s=2e-3)
    spring = having(LEG, EffectKey("joint_compliance", "hip"), stiffness=300.0, damping=0.6)
    tight = having(damped, EffectKey("backlash", "hip"), gap=0.0, stiffness=300.0)
    first, second = simulated(spring, experiment("leg")), simulated(tight, experiment("leg"))
    np.testing.assert_array_equal(first.position, second.position)


@pytest.mark.parametrize("stiffness", [30.0, 3000.0])
def test_motor_and_link_ring_at_their_frequency(stiffness: float) -> None:
    """w^2 = k (1/J + 1/M) about a drive that is left alone, M the link's inertia with the other axis free."""
    still = replace(LEG, actuators=replace(LEG.actuators, damping=(0.0, 0.0)))
    plant = compile_plant(
        having(still, EffectKey("joint_compliance", "knee"), stiffness=stiffness, damping=0.0)
    )
    m = plant.mujoco
    data = mujoco.MjData(m)
    m.opt.gravity[:] = 0.0
    rotor = m.joint("rotor:actuator:1").dofadr[0]
    data.qvel[rotor] = 0.05
    seen = []
    for _ in range(round(0.3 / m.opt.timestep)):
        mujoco.mj_step(m, data)
        seen.append(data.qpos[rotor] - data.qpos[0] - data.qpos[1])
    crossings = np.flatnonzero(np.diff(np.sign(seen)))
    period = 2.0 * np.mean(np.diff(crossings)) * m.opt.timestep
    links = np.array([[0.04793, 0.005413], [0.005413, 0.00748]])  # alpha = 0; the hip's rotor is rigid
    give = 1.0 / 0.0162 + np.linalg.inv(links)[1, 1]
    assert 2.0 * np.pi / period == pytest.approx(np.sqrt(stiffness * give), rel=0.01)


@pytest.mark.parametrize("retardation", [0.0, 0.01])
def test_motors_move_freely_within_a_gap(retardation: float) -> None:
    """An open loop pushes the hip's motor across its play: until the flank only the rotor accelerates."""
    wide = having(
        replace(LEG, flank_retardation_s=retardation), EffectKey("backlash", "hip"), gap=0.2, stiffness=500.0
    )
    asked = replace(leg_experiment(0.05), controller=Controller("none"))
    push = np.zeros((len(asked), 2))
    push[:, 0] = 2.0
    run = simulated(wide, asked.with_signals(torque_command=push))
    away = run.position[:, 0] - run.position[0, 0]
    free = np.flatnonzero(away < 0.08)
    damped = 0.0972 / 0.0162
    t = np.maximum(asked.time - 0.003, 0.0)
    expected = 2.0 / 0.0972 * (t - (1.0 - np.exp(-damped * t)) / damped)
    np.testing.assert_allclose(away[free], expected[free], atol=2e-4)


def test_what_sits_at_a_drive_moves_with_its_motor() -> None:
    rubs = having(LEG, EffectKey("coulomb_friction", "knee"), torque=0.2)
    rubs = having(rubs, EffectKey("reflected_inertia", "knee"), inertia=0.01)
    made = build(having(rubs, EffectKey("joint_compliance", "knee"), stiffness=60.0, damping=0.0))
    tendon = made.spec.tendon("actuator:1")
    assert made.rows["actuator:1"] == {"rotor:actuator:1": 1.0}
    assert (tendon.frictionloss, tendon.armature) == (0.2, pytest.approx(0.0262))


@pytest.mark.parametrize(("stiffness", "damping"), [(40.0, 0.05), (3000.0, 0.0), (900.0, 60.0)])
def test_a_spring_winds_up_as_its_equation_says(stiffness: float, damping: float) -> None:
    """Inertia d'' + damping d' + stiffness d = torque, which goes straight from row to row."""
    step, inertia = 0.002, 0.05
    torque = np.cumsum(np.random.default_rng(0).standard_normal(500))
    torque -= torque[0]
    change = np.array([[0.0, 1.0], [-stiffness / inertia, -damping / inertia]])
    through = np.array([[0.0], [1.0 / inertia]])
    system = signal.StateSpace(change, through, change[1:], through[1:])
    _, wanted, _ = signal.lsim(system, torque, step * np.arange(len(torque)))
    wind = spring_wind(torque, step, inertia, stiffness, damping)
    np.testing.assert_allclose(wind, wanted, atol=1e-9 * np.abs(wanted).max())


def test_an_axis_has_one_spring_in_series() -> None:
    soft = having(LEG, EffectKey("joint_compliance", "knee"), stiffness=60.0, damping=0.0)
    with pytest.raises(InputError, match="does not apply"):
        having(soft, EffectKey("backlash", "knee"), gap=0.01, stiffness=100.0)
    with pytest.raises(InputError, match="does not apply"):
        having(TREE, EffectKey("joint_compliance", "knee"), stiffness=60.0, damping=0.0)


@pytest.mark.parametrize("name", ["leg", "emps"])
def test_a_stiff_base_stands_still(name: str) -> None:
    model, asked = load_model(name), experiment(name)
    firm = having(model, EffectKey("base_compliance", None), stiffness=1e9, damping=1e4, mass=50.0)
    loose = having(model, EffectKey("base_compliance", None), stiffness=2e4, damping=50.0, mass=10.0)
    moved, far = (
        np.abs(simulated(x, asked).position - reference(name).position).max() for x in (firm, loose)
    )
    assert moved < 1e-2 * far


def test_a_base_and_its_machine_are_two_masses_on_a_spring() -> None:
    """The carriage pushes itself off a free base: what one gains in momentum the other has."""
    model = load_model("emps")
    floats = having(model, EffectKey("base_compliance", None), stiffness=1e-3, damping=0.0, mass=95.1)
    asked = replace(slide_experiment(model, 0.2), controller=Controller("none"))
    pushed = asked.with_signals(torque_command=np.full((len(asked), 1), 50.0))
    fixed, moved = simulated(model, pushed), simulated(floats, pushed)
    np.testing.assert_allclose(moved.velocity[-1], 2.0 * fixed.velocity[-1], rtol=1e-3)


def test_a_longer_thigh_carries_its_end_farther_out() -> None:
    long = having(LEG, EffectKey("link_length_error", "hip"), length=0.02)
    q = np.array([[0.3, 0.8], [-0.5, 0.9]])
    zero = np.zeros_like(q)
    weight = required_torque(compile_plant(long), Track(q, zero, zero))
    before = required_torque(compile_plant(LEG), Track(q, zero, zero))
    # the serial tree's shank, and the linkage's weight as of a mass there
    hanging = 9.81 * 0.16 + 0.163091 / 0.175
    np.testing.assert_allclose((weight - before)[:, 0], 0.02 * hanging * np.sin(q[:, 0]), rtol=1e-4)
    np.testing.assert_allclose((weight - before)[:, 1], 0.0, atol=1e-9)


def test_a_longer_shank_moves_the_foot_and_its_payload_alone() -> None:
    loaded = having(LEG, EffectKey("payload_mass", None), mass=0.3)
    key = EffectKey("link_length_error", "knee")
    base, long = compile_plant(loaded).mujoco, compile_plant(having(loaded, key, length=0.03)).mujoco
    assert long.site("foot").pos[2] == pytest.approx(base.site("foot").pos[2] - 0.03)
    changed = np.flatnonzero(np.any(base.body_pos != long.body_pos, axis=1))
    assert [float(base.body_mass[k]) for k in changed] == [0.3]


def test_the_column_of_a_length_is_what_a_longer_link_needs() -> None:
    key = EffectKey("link_length_error", "hip")
    run = reference("leg")
    track = Track(run.position, run.velocity, np.gradient(run.velocity, run.period, axis=0))
    motion = motion_of(track, run, compile_plant(LEG), np.eye(2))
    (column,) = effect_named(key.effect).response(motion, LEG, Placement.of(LEG, key), {}).columns
    longer = having(LEG, key, length=0.004)
    expected = (
        required_torque(compile_plant(LEG), track) - required_torque(compile_plant(longer), track)
    ) / 0.004
    size = np.sqrt(np.mean(expected**2))
    assert np.sqrt(np.mean((column - expected) ** 2)) < 0.03 * size
