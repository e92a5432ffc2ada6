"""Policies of the quadruped over CAN: twelve drives, four buses, an inertial unit, and the same motion."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from virtual_robot import four_legs

from workbench.bundle import PolicyBundle, read_bundle
from workbench.can import CanConfig, Frame, Setpoint, bus_load, load_config
from workbench.core import InputError
from workbench.deployment import Host, SimulatedNetwork, joints_of
from workbench.deployment.deploy import controller_of, deploy
from workbench.deployment.drives import CALM
from workbench.deployment.stopping import exit_code
from workbench.rigs import MotorBank, VirtualMotor
from workbench.rigs.quadruped import LiveQuadruped
from workbench.training.environment import STEEPEST
from workbench.training.evaluate import evaluate
from workbench.training.tasks import CIRCLE, PITCH_HZ, TASKS

POLICIES = Path(__file__).resolve().parents[2] / "policies"
RUN_S = 3.0  # of the policy; the first second is not judged
START_S = {"soft_start_s": 0.4, "hold_s": 0.2}  # shorter than usual: the policy is what is tested
RUNS_S = 0.62  # from when on it does
PUSHED_S = RUNS_S + 0.4  # when somebody pushes it


def robot(folder: Path, bundle: PolicyBundle) -> CanConfig:
    machine = hashlib.sha256(bundle.machine.encode()).hexdigest()[:16]
    config = load_config(four_legs(folder, machine=machine))
    return config.model_copy(update={"loop": config.loop.model_copy(update=START_S)})


def moved(config: CanConfig, bundle: PolicyBundle, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gravity, linear and angular velocity of the trunk (N, 3), a second after the policy began."""
    network = SimulatedNetwork(config, MotorBank(config, seed=seed))
    trunk = network.bank.robot
    assert trunk is not None
    rows: list[tuple[np.ndarray, ...]] = []
    network.every_row = lambda now: rows.append(trunk.motion) if not trunk.held else None
    result = deploy(config, bundle, RUNS_S + RUN_S, seed=seed, network=network, twist=CIRCLE)
    assert result["fault"] is None and result["missed_share"] == 0.0
    assert result["frames"]["base"] > 3 * (RUNS_S + RUN_S) / config.imu.period_s - 20  # type: ignore[union-attr]
    wanted = round((RUN_S - 1.0) / network.bank.row)
    calm = round(0.52 / network.bank.row)  # it damps before it is switched off
    return tuple(np.array([row[k] for row in rows[-wanted - calm : -calm]]) for k in range(3))  # type: ignore[return-value]


def test_it_pitches_as_it_does_when_it_is_evaluated(tmp_path: Path) -> None:
    bundle = read_bundle(POLICIES / "pitch-in-place_s3n_full.zip")
    direct = evaluate(bundle, seconds=RUN_S, seed=1).scores
    gravity, _, angular = moved(robot(tmp_path, bundle), bundle, 1)
    low, high = np.percentile(angular[:, 1], [1, 99])
    assert high - low == pytest.approx(direct["pitch_rate_peak_to_peak_rad_s"], rel=0.04)
    amplitude = np.sqrt(2.0) * np.std(np.arcsin(gravity[:, 0]))
    assert amplitude == pytest.approx(direct["pitch_amplitude_rad"], rel=0.04)


def test_it_runs_as_it_does_when_it_is_evaluated(tmp_path: Path) -> None:
    bundle = read_bundle(POLICIES / "circular_s3n_full.zip")
    direct = evaluate(bundle, seconds=RUN_S, seed=1).scores
    _, linear, angular = moved(robot(tmp_path, bundle), bundle, 1)
    assert linear[:, 0].mean() == pytest.approx(direct["forward_m_s"], abs=0.02)
    assert angular[:, 2].mean() == pytest.approx(direct["yaw_rad_s"], abs=0.02)


def test_an_inertial_unit_that_falls_silent_damps(tmp_path: Path) -> None:
    bundle = read_bundle(POLICIES / "circular_s3n_full.zip")
    config = robot(tmp_path, bundle)
    network, joints = SimulatedNetwork(config), joints_of(config)
    host = Host(config, network, controller_of(bundle, config, joints, 0), joints)
    host.verify()
    host.operator.arm = True
    host.run(RUNS_S)
    assert host.state.phase == "run"
    silent = network.now()
    network.wires["fl"].lost = lambda node, frame: frame.id == 0x60
    host.run(0.05, lambda h, _: h.state.phase == "damp")
    assert host.state.fault == "no data of the base for 9 ms"
    assert host.state.since - silent <= 0.009 + config.loop.period_s


def test_a_robot_that_does_not_fit_is_refused(tmp_path: Path) -> None:
    bundle = read_bundle(POLICIES / "circular_s3n_full.zip")
    config = robot(tmp_path, bundle)
    with pytest.raises(InputError, match="there is no inertial unit"):
        deploy(config.model_copy(update={"imu": None}), bundle, 1.0, network=SimulatedNetwork(config))
    with pytest.raises(InputError, match="a quadruped has 12 axes, here are 9"):
        MotorBank(config.model_copy(update={"motor": config.motor[:9]}))


def test_tasks_and_deployment_mean_the_same() -> None:
    from workbench.deployment.observe import PITCH_HZ as OURS
    from workbench.deployment.trained import COMMANDS, TILT

    assert OURS == PITCH_HZ and math.cos(TILT) == pytest.approx(STEEPEST)
    assert {name: task.commands for name, task in TASKS.items() if task.commands} == COMMANDS


def test_the_unit_counts_in_the_load_of_its_bus(tmp_path: Path) -> None:
    bundle = read_bundle(POLICIES / "circular_s3n_full.zip")
    first, second, *_ = bus_load(robot(tmp_path, bundle))
    assert first.frames - second.frames == pytest.approx(3 / 0.003)
    assert 0.09 < first.share - second.share < 0.13


def overturned(network: SimulatedNetwork, at: float, degrees: float) -> None:
    """From some time on the trunk lies as if it had been turned over by so much, whatever the drives do."""
    trunk = network.bank.robot
    assert trunk is not None
    feel, roll = trunk.feel, math.radians(degrees)
    down = np.array([0.0, -math.sin(roll), -math.cos(roll)])
    trunk.feel = lambda: (feel()[0], down, -down) if network.now() > at else feel()


@pytest.mark.parametrize("degrees", [55.0, 90.0, 180.0])
def test_a_robot_that_fell_damps_and_says_so(tmp_path: Path, degrees: float) -> None:
    bundle = read_bundle(POLICIES / "circular_s3n_full.zip")
    config = robot(tmp_path, bundle)
    network = SimulatedNetwork(config, MotorBank(config))
    overturned(network, RUNS_S, degrees)
    result = deploy(config, bundle, RUNS_S + 1.5, network=network)
    assert result["fault"] == f"tilted by {degrees:.0f} degrees, beyond 53"
    assert result["ticks"] * 0.003 < RUNS_S + 0.6 and not any(m.enabled for m in network.bank.motors.values())


def heard(motor: VirtualMotor) -> list[Setpoint]:
    """Setpoints of torque or stiffness that a motor hears from now on."""
    told, hear = list[Setpoint](), motor.hear

    def listen(frame: Frame) -> None:
        asked = motor.drive.asked(frame)
        if isinstance(asked, Setpoint) and (abs(asked.torque) > 0.01 or asked.kp):
            told.append(asked)
        hear(frame)

    motor.hear = listen  # type: ignore[method-assign]
    return told


def test_a_robot_that_lies_on_its_back_is_never_armed(tmp_path: Path) -> None:
    bundle = read_bundle(POLICIES / "circular_s3n_full.zip")
    config = robot(tmp_path, bundle)
    network = SimulatedNetwork(config, MotorBank(config))
    overturned(network, -1.0, 170.0)
    told = heard(next(iter(network.bank.motors.values())))
    result = deploy(config, bundle, 1.0, network=network)
    assert result["fault"] == "tilted by 170 degrees, beyond 53"
    assert not told


def pushed(network: SimulatedNetwork, at: float, push: Callable[[LiveQuadruped, float], None]) -> list[float]:
    """Somebody pushes the trunk in its world, row by row; how far it is truly tilted since then [rad]."""
    trunk, tilts = network.bank.robot, list[float]()
    assert trunk is not None

    def row(now: float) -> None:
        if now >= at:
            push(trunk, now - at)
            tilts.append(math.acos(np.clip(-trunk.motion[0][2], -1.0, 1.0)))

    network.every_row = row
    return tilts


def test_a_robot_that_is_pushed_over_damps_while_it_goes_over(tmp_path: Path) -> None:
    bundle = read_bundle(POLICIES / "pitch-in-place_s3n_full.zip")
    config = robot(tmp_path, bundle)
    network = SimulatedNetwork(config, MotorBank(config))
    trunk = network.bank.robot
    tilts = pushed(network, PUSHED_S, lambda t, _: t.push(0.05, -0.005) if -t.motion[0][2] > 0.4 else None)
    result = deploy(config, bundle, RUNS_S + 2.5, network=network)
    assert re.fullmatch(r"tilted by 5[34] degrees, beyond 53", result["fault"] or ""), result["fault"]
    assert exit_code(result) == 1
    damped = len(tilts) - round((CALM + 0.012) / network.bank.row)  # and three times disabled
    assert tilts[damped] == pytest.approx(math.acos(0.6), abs=0.15)
    assert tilts[-1] > math.radians(70.0), "it does lie in its world"
    assert trunk and not any(m.enabled for m in network.bank.motors.values())


def test_a_robot_that_stumbles_goes_on(tmp_path: Path) -> None:
    bundle = read_bundle(POLICIES / "circular_s3n_full.zip")
    config = robot(tmp_path, bundle)
    network = SimulatedNetwork(config, MotorBank(config))
    pushed(network, PUSHED_S, lambda t, since: t.push(2.5) if since < network.bank.row else None)
    result = deploy(config, bundle, PUSHED_S + 0.8, network=network, twist=CIRCLE)
    assert result["fault"] is None and exit_code(result) == 0


def test_a_robot_that_falls_without_tilting_damps(tmp_path: Path) -> None:
    bundle = read_bundle(POLICIES / "pitch-in-place_s3n_full.zip")
    config = robot(tmp_path, bundle)
    network = SimulatedNetwork(config, MotorBank(config))
    # thrown up it is as weightless as over an edge
    tilts = pushed(network, PUSHED_S, lambda t, since: t.push(0.0, 2.0) if since < network.bank.row else None)
    result = deploy(config, bundle, RUNS_S + 2.5, network=network)
    assert result["fault"] == "falls freely" and exit_code(result) == 1
    after = result["ticks"] * config.loop.period_s - CALM - PUSHED_S
    assert 0.05 < after < 0.13 and max(tilts[: round(after / network.bank.row)]) < math.radians(45.0)


@pytest.mark.parametrize("degrees", [90.0, 180.0])
def test_a_robot_that_was_laid_down_is_never_armed(tmp_path: Path, degrees: float) -> None:
    bundle = read_bundle(POLICIES / "circular_s3n_full.zip")
    config = robot(tmp_path, bundle)
    network = SimulatedNetwork(config, MotorBank(config))
    trunk = network.bank.robot
    assert trunk is not None
    trunk.lay(math.radians(degrees), 0.3)
    motions = [heard(motor) for motor in network.bank.motors.values()]
    result = deploy(config, bundle, 1.0, network=network)
    said = re.fullmatch(r"tilted by (\d+) degrees, beyond 53", result["fault"])
    assert said and abs(float(said[1]) - degrees) < 2.0 and exit_code(result) == 1
    assert all(not told for told in motions), "no drive was told to do anything"


def test_by_itself_it_is_asked_to_stand(tmp_path: Path) -> None:
    bundle = read_bundle(POLICIES / "circular_s3n_full.zip")
    config = robot(tmp_path, bundle)
    network = SimulatedNetwork(config, MotorBank(config))
    result = deploy(config, bundle, RUNS_S + 1.5, network=network)
    trunk = network.bank.robot
    assert trunk is not None and result["fault"] is None
    assert np.hypot(*trunk.pose[4:6]) < 0.4, "at 0.8 m/s it would have run for two metres"
