"""The exam's plants agree with Pinocchio, Drake and MuJoCo, and with their own smaller steps."""

from dataclasses import replace

import mujoco
import numpy as np
import pinocchio
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import MultibodyForces
from scipy.integrate import solve_ivp
from workbench_exam.plants import march
from workbench_exam.plants.chain import GRAVITY, Link, Machine
from workbench_exam.plants.drives import plain
from workbench_exam.plants.dynamics import inertias, needed
from workbench_exam.plants.files import mjcf, urdf
from workbench_exam.plants.machines import MACHINES, draw_machine
from workbench_exam.plants.plant import Plant, play, with_effect

NOBODY = np.zeros((0, 6))


def bare(machine: Machine) -> Machine:
    """Without friction and damping."""
    return replace(machine, links=tuple(replace(x, friction=0.0, damping=0.0) for x in machine.links))


def states(n: int) -> list[np.ndarray]:
    draw = np.random.default_rng(3)
    return [draw.normal(size=(3, n)) * [[1.0], [3.0], [10.0]] for _ in range(4)]


@pytest.mark.parametrize("family", MACHINES)
def test_mass_and_torques_are_those_of_pinocchio_and_drake(family: str) -> None:
    machine = bare(draw_machine(family, 4))
    m, _ = plain(machine)
    model = pinocchio.buildModelFromXML(urdf(machine))
    model.gravity.linear = np.array([0.0, 0.0, -GRAVITY])
    data = model.createData()
    drake = MultibodyPlant(0.0)
    Parser(drake).AddModelsFromString(urdf(machine), "urdf")
    drake.WeldFrames(drake.world_frame(), drake.GetFrameByName("base"))
    drake.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -GRAVITY])
    drake.Finalize()
    context, forces = drake.CreateDefaultContext(), MultibodyForces(drake)
    for q, w, a in states(len(machine.links)):
        out = np.zeros(len(q))
        needed(q, w, a, GRAVITY, m, out)
        np.testing.assert_allclose(out, pinocchio.rnea(model, data, q, w, a), rtol=1e-7, atol=1e-7)
        full = pinocchio.crba(model, data, q)
        np.testing.assert_allclose(inertias(q, m), np.triu(full) + np.triu(full, 1).T, rtol=1e-7, atol=1e-9)
        drake.SetPositions(context, q)
        drake.SetVelocities(context, w)
        drake.CalcForceElementsContribution(context, forces)
        np.testing.assert_allclose(out, drake.CalcInverseDynamics(context, a, forces), rtol=1e-7, atol=1e-7)
        np.testing.assert_allclose(
            inertias(q, m), drake.CalcMassMatrixViaInverseDynamics(context), rtol=1e-7, atol=1e-9
        )


@pytest.mark.parametrize("family", MACHINES)
def test_the_mjcf_file_is_the_machine_with_its_drives(family: str) -> None:
    machine = draw_machine(family, 4)
    model = mujoco.MjModel.from_xml_string(mjcf(machine))
    data = mujoco.MjData(model)
    m, d = plain(machine)
    for q, _, _ in states(len(machine.links)):
        data.qpos[:] = q
        mujoco.mj_forward(model, data)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        mine = inertias(q, m) + d.couple.T @ np.diag(d.armature) @ d.couple
        np.testing.assert_allclose(mine, full, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("family", MACHINES)
def test_free_motion_is_that_of_pinocchio(family: str) -> None:
    machine = bare(draw_machine(family, 8))
    m, d = plain(machine)
    model = pinocchio.buildModelFromXML(urdf(machine))
    model.gravity.linear = np.array([0.0, 0.0, -GRAVITY])
    data, n = model.createData(), len(machine.links)
    rotors = d.couple.T @ np.diag(d.armature) @ d.couple
    start = np.linalg.solve(d.couple, machine.posture) + 0.2

    def rate(_: float, x: np.ndarray) -> np.ndarray:
        bias = pinocchio.nonLinearEffects(model, data, x[:n], x[n:])
        full = pinocchio.crba(model, data, x[:n])
        return np.concatenate([x[n:], np.linalg.solve(np.triu(full) + np.triu(full, 1).T + rotors, -bias)])

    there = solve_ivp(rate, (0, 0.5), np.concatenate([start, np.zeros(n)]), rtol=1e-10, atol=1e-12).y[:, -1]
    q, w, th, om, none = start.copy(), np.zeros(n), d.couple @ start, np.zeros(n), np.zeros(n)
    for k in range(1000):
        march.step(k * 5e-4, 5e-4, q, w, th, om, none, none.copy(), m, d, NOBODY)
    np.testing.assert_allclose(np.concatenate([q, w]), there, atol=2e-7)


def test_a_soft_coupling_is_two_inertias_on_a_spring() -> None:
    machine = bare(draw_machine("geared", 2))
    link = machine.links[0]
    at_hinge = link.inertia[1] + link.mass * link.centre[0] ** 2
    soft = with_effect(Plant(machine), "joint_compliance", "lift", {"stiffness": 300.0, "damping": 0.4})
    m, d = plain(machine)
    d = d._replace(**{name: np.array(column) for name, column in soft.drives.items()})

    def rate(_: float, x: np.ndarray) -> list[float]:
        q, th, w, om = x
        through = 300.0 * (th - q) + 0.4 * (om - w)
        weight = link.mass * GRAVITY * link.centre[0] * np.cos(q)
        return [w, om, (through + weight) / at_hinge, -through / link.armature]

    there = solve_ivp(rate, (0, 0.25), [0.1, 0.12, 0.0, 0.0], rtol=1e-10, atol=1e-12).y[:, -1]
    q, th, w, om, none = np.array([0.1]), np.array([0.12]), np.zeros(1), np.zeros(1), np.zeros(1)
    for k in range(500):
        march.step(k * 5e-4, 5e-4, q, w, th, om, none, none.copy(), m, d, NOBODY)
    assert [q[0], th[0], w[0], om[0]] == pytest.approx(there, abs=2e-6)


@pytest.mark.parametrize(
    ("family", "effect", "values"),
    [
        ("arm", "coulomb_friction", {"torque": 0.5}),
        ("geared", "backlash", {"gap": 0.02, "stiffness": 2000.0}),
        ("leg", "cogging", {"torque": 0.2, "order": 12.0, "phase": 1.0}),
    ],
)
def test_smaller_steps_change_less_than_an_encoder_shows(
    family: str, effect: str, values: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    machine = draw_machine(family, 6)
    plant = with_effect(Plant(machine), effect, machine.axes[0], values)
    usual = play(plant, 6, 1, 2.0, 2e-3, noisy=False)
    monkeypatch.setattr("workbench_exam.plants.plant.STEP", 1e-4)
    small = play(plant, 6, 1, 2.0, 2e-3, noisy=False)
    assert np.sqrt(np.mean((usual.angle - small.angle) ** 2)) < machine.noise[2]


def slider(friction: float) -> Machine:
    link = Link(
        "x", (1, 0, 0), (0, 0, 0), 1.5, (0, 0, 0), (1e-3, 1e-3, 1e-3), 0.5, 0.0, friction, slides=True
    )
    return Machine("slider", (link,), (0, 0, 0), (0.0,), (0.0,), (0.0,), (0.1,))


def test_dry_friction_stops_a_mass_where_it_should_and_holds_it() -> None:
    m, d = plain(slider(3.0))
    q, w, rub, th, om = np.zeros(1), np.array([1.2]), np.zeros(1), np.zeros(1), np.zeros(1)
    places = []
    for k in range(8000):
        march.step(k * 2e-4, 2e-4, q, w, th, om, np.array([1.0]), rub, m, d, NOBODY)
        places.append(q[0])
    # 2 kg slowed by 3 N against a push of 1 N
    assert q[0] == pytest.approx(1.2**2 / 2 / (2.0 / 2.0), rel=1e-3)
    assert w[0] == 0.0 and places[-1] == places[-1500] and rub[0] == pytest.approx(-1.0)
    march.step(0.0, 2e-4, q, w, th, om, np.array([3.1]), rub, m, d, NOBODY)
    assert w[0] == pytest.approx(0.1 / 2.0 * 2e-4, rel=1e-6)


def test_friction_holds_some_drives_while_others_move() -> None:
    machine = draw_machine("arm", 3)
    m, d = plain(machine)
    start = np.linalg.solve(d.couple, machine.posture)
    rest = np.zeros(len(start))
    needed(start, rest, rest, GRAVITY, m, weight := np.zeros(len(start)))
    push = np.linalg.solve(d.couple.T, weight)
    push[-1] += 3.0
    q, w, rub, th, om = start.copy(), rest.copy(), rest.copy(), d.couple @ start, rest.copy()
    for k in range(150):
        march.step(k * 5e-4, 5e-4, q, w, th, om, push, rub, m, d, NOBODY)
    moved = np.abs(th - machine.posture)
    assert moved[0] < 1e-9 and moved[-1] > 0.01


def test_delay_and_lag_stand_between_command_and_torque() -> None:
    machine = draw_machine("geared", 3)
    late = play(
        with_effect(Plant(machine), "command_delay", None, {"time": 0.004}), 3, 1, 1.0, 2e-3, noisy=False
    )
    np.testing.assert_array_equal(late.torque[2:], late.command[:-2])
    slow = play(
        with_effect(Plant(machine), "current_loop_lag", "lift", {"time_constant": 0.005}),
        3,
        1,
        1.0,
        2e-3,
        noisy=False,
    )
    kept = np.exp(-2e-3 / 0.005)
    np.testing.assert_allclose(
        slow.torque[1:], slow.command[:-1] + (slow.torque[:-1] - slow.command[:-1]) * kept, atol=1e-9
    )


def test_measured_torque_has_its_sensors_noise_where_a_motor_is() -> None:
    machine = draw_machine("cart", 1)
    ticks = play(Plant(machine), 1, 1, 4.0, 2e-3)
    noise = ticks.sensed - ticks.torque
    assert noise[:, 0].std() == pytest.approx(machine.noise[1], rel=0.1) and not noise[:, 1].any()
