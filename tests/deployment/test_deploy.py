"""Policies over CAN: what fits runs, what does not is refused in one line, and the tracker tracks."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.can.make import motor, table, written
from tests.deployment.robot import HOLD, LIMITS, RANGES
from workbench.bundle import PolicyBundle, read_bundle, write_bundle
from workbench.can import load_config
from workbench.cli.app import app
from workbench.core import InputError
from workbench.deployment import Host, SimulatedNetwork, joints_of
from workbench.deployment.base import BaseMotion
from workbench.deployment.deploy import deploy
from workbench.deployment.observe import OBSERVATIONS, Reach, Sight
from workbench.deployment.policies import PolicyController, Tracker, check_bundle
from workbench.training.export import to_onnx
from workbench.training.tasks import TASKS, reach_reference

MACHINE = "<mujoco model='leg'/>"
STILL = BaseMotion(np.zeros(3), np.array([0.0, 0.0, -1.0]))
SIZES = {"reach_ahead": 8}  # all others 2


def bundle(folder: Path, **control: object) -> Path:
    """A policy that always answers zero: hold the posture."""
    entries, at = [], 0
    for entry in TASKS["reach"].observations:
        size = SIZES.get(entry.name, 2)
        entries.append(
            {"name": entry.name, "start": at, "size": size, "scale": entry.scale, "about": entry.about}
        )
        at += size
    one = np.ones((1, at), np.float32)
    weight, bias = np.zeros((2, at), np.float32), np.zeros(2, np.float32)
    actor = {"obs_normalizer._mean": 0 * one, "obs_normalizer._std": one,
             "mlp.0.weight": weight, "mlp.0.bias": bias}  # fmt: skip
    own = {
        "joints": ["hip", "knee"], "transmission": [[1.0, 0.0], [1.0, 1.0]], "posture": HOLD.tolist(),
        "action_scale": 0.5, "kp": [50.0, 50.0], "kd": [1.5, 1.5], "torque_limit": [24.0, 24.0],
        "joint_limits": [[-1.6, 1.6], [0.35, 2.6]], "control_period_s": 0.003, "policy_period_s": 0.018,
        "delay_steps": 1, **control,
    }  # fmt: skip
    manifest = {"task": "reach", "variant": "exact", "observations": entries, "control": own}
    return write_bundle(folder / "reach.zip", manifest, to_onnx(actor), MACHINE, {}, force=True)


def leg(folder: Path, **more: object) -> Path:
    motors = [motor(axis, k + 1, limits=LIMITS, ranges=RANGES) for k, axis in enumerate(("hip", "knee"))]
    machine = hashlib.sha256(MACHINE.encode()).hexdigest()[:16]
    content = table(motors, mechanism=[{"model": "leg", "axes": ["hip", "knee"]}],
                    **{"loop": {"soft_start_s": 0.1}, "machine": machine, **more})  # fmt: skip
    return written(folder, content)


def test_a_bundle_that_fits_runs(tmp_path: Path) -> None:
    done = CliRunner().invoke(
        app,
        ["deploy", str(bundle(tmp_path)), str(leg(tmp_path)), "--dry-run", "--seconds", "1.5",
         "--json", str(tmp_path / "run.json")],
    )  # fmt: skip
    assert done.exit_code == 0, done.output
    said = json.loads((tmp_path / "run.json").read_text())
    assert said["fault"] is None and said["ticks"] > 500 and said["skipped"] == 0
    assert said["round_trip_ms"]["p99"] < 1.0
    made = said["provenance"]
    assert made["seeds"] == {"run": 0} and made["versions"]["workbench"]
    read = [each["file"] for each in made["inputs"]]
    assert read == ["robot.toml", "reach.zip", "leg.toml", "leg.xml", "leg.sdf"]


@pytest.mark.parametrize(
    ("control", "more", "said"),
    [
        ({"kp": [60.0, 50.0]}, {}, "kp [60., 50.], the configuration has [50., 50.]"),
        ({"kd": [1.5, 2.0]}, {}, "kd [1.5, 2. ]"),
        ({"transmission": [[1.0, 0.0], [0.0, 1.0]]}, {}, "transmission"),
        ({"control_period_s": 0.002}, {}, "control period 0.002"),
        ({"policy_period_s": 0.02}, {}, "policy period 0.02"),
        ({"delay_steps": 0}, {}, "give the model delay_s = 0.003"),
        ({}, {"machine": ""}, "names none"),
        ({}, {"machine": "0123"}, "says 0123"),
        ({}, {"loop": {"pd": "drive"}}, "PD on the host"),
    ],
)  # fmt: skip
def test_a_bundle_for_something_else_is_refused(tmp_path: Path, control, more, said) -> None:
    config = load_config(leg(tmp_path, **more))
    with pytest.raises(InputError) as caught:
        check_bundle(read_bundle(bundle(tmp_path, **control)), config, joints_of(config))
    assert said in str(caught.value)


def test_observations_that_drives_cannot_tell_are_refused(tmp_path: Path) -> None:
    config, loaded = load_config(leg(tmp_path)), read_bundle(bundle(tmp_path))
    first, *rest = loaded.observations
    for wrong, said in (
        (type(first)("foot_load", 0, 2, 1.0, ""), "'foot_load', which is not available here"),
        (type(first)("gravity", 0, 3, 1.0, ""), "'gravity', but there is no inertial unit"),
        (type(first)("reach_ahead", 0, 2, 1.0, ""), "has 2 numbers from 0, here 8"),
    ):
        changed = PolicyBundle(**{**vars(loaded), "observations": (wrong, *rest)})
        with pytest.raises(InputError, match=said):
            check_bundle(changed, config, joints_of(config))


def test_a_policy_sees_what_it_was_trained_to_see() -> None:
    assert {entry.name for entry in TASKS["reach"].observations} <= OBSERVATIONS.keys()
    command = np.array([-0.4, 1.1, 0.3, 0.2, 3.0, 5.0, 0.1, 0.7])
    goal = Reach(*command.reshape(4, 2))
    for time in (0.0, 0.33):
        angle, speed = reach_reference(np, command[None], np.array([time]))
        assert goal.position(time) == pytest.approx(angle[0]) and goal.velocity(time) == pytest.approx(
            speed[0]
        )
    sight = Sight(
        HOLD, np.ones(2), HOLD, np.ones(2), goal, 0.1, 0.018, STILL.angular, STILL.gravity, np.zeros(3)
    )
    ahead = [
        reach_reference(np, command[None], np.array([0.1 + k * 0.018]))[0][0] - HOLD for k in (0, 1, 2, 4)
    ]
    assert OBSERVATIONS["reach_ahead"](sight) == pytest.approx(np.concatenate(ahead))


def test_a_policy_is_asked_every_sixth_tick_and_held_in_between(tmp_path: Path) -> None:
    asked: list[np.ndarray] = []

    def act(seen: np.ndarray) -> np.ndarray:
        asked.append(seen)
        return np.full(2, 0.1 * len(asked))

    goal = Reach(HOLD, np.zeros(2), np.ones(2), np.zeros(2))
    controller = PolicyController(read_bundle(bundle(tmp_path)), act, goal, 6, 0.003)
    targets = [controller.target(5.0 + k * 0.003, "run", HOLD, np.zeros(2), STILL) for k in range(18)]
    assert len(asked) == 3 and all(len(seen) == 18 for seen in asked)
    assert [t.reference[0] - HOLD[0] for t in targets[::6]] == pytest.approx([0.05, 0.1, 0.15])
    assert (
        targets[11].reference == pytest.approx(targets[6].reference) and targets[11].made == targets[6].made
    )
    assert asked[1][-2:] == pytest.approx([0.1, 0.1]), "it sees its last action"


def test_a_policy_that_fails_damps(tmp_path: Path) -> None:
    config = load_config(leg(tmp_path))
    calls: list[int] = []

    def act(seen: np.ndarray) -> np.ndarray:
        calls.append(1)
        return np.full(2, np.nan) if len(calls) > 3 else np.zeros(2)

    goal = Reach(HOLD, np.zeros(2), np.ones(2), np.zeros(2))
    controller = PolicyController(read_bundle(bundle(tmp_path)), act, goal, 6, 0.003)
    host = Host(config, SimulatedNetwork(config), controller, joints_of(config))
    host.verify()
    host.operator.arm = True
    host.run(0.5)
    assert host.state.phase == "damp" and host.state.fault == "an action is not a number"


def test_the_tracker_tracks(tmp_path: Path) -> None:
    config = load_config(leg(tmp_path))
    joints, goal = joints_of(config), Reach(HOLD, np.full(2, 0.2), np.full(2, 4.0), np.zeros(2))
    host = Host(config, SimulatedNetwork(config), Tracker(goal), joints)
    host.verify()
    host.operator.arm = True
    errors: list[np.ndarray] = []

    def look(host: Host, tick: int) -> None:
        wanted = goal.position(host.time - host.state.since)
        errors.append(joints.position(host.feedback.position) - wanted)

    host.run(2.0, look)
    assert host.state.phase == "run" and np.abs(errors[-300:]).max() < 0.2
    assert deploy(config, None, 0.5, network=SimulatedNetwork(config))["fault"] is None


def test_a_full_bus_is_not_deployed_on(tmp_path: Path) -> None:
    motors = [motor(f"m{k}", k + 1, limits=LIMITS, ranges=RANGES) for k in range(12)]
    config = load_config(written(tmp_path, table(motors)))
    with pytest.raises(InputError, match="108 % full"):
        deploy(config, None, 1.0, network=SimulatedNetwork(config))
