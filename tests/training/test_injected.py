"""The paper's injected torques, in worlds that train and in those that judge."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from workbench.core import InputError
from workbench.effects import load_model
from workbench.s3n import run_variant
from workbench.training.injected import EXPLICIT, InjectedWorlds
from workbench.training.learn import make_worlds
from workbench.training.machine import STEP_S, make_machine
from workbench.training.plants import TrainedPlant
from workbench.training.settings import Settings

from .make import machine


def started(kind: str, worlds: int = 3) -> InjectedWorlds:
    made = make_worlds(machine(kind, EXPLICIT), Settings(worlds=worlds, threads=1), seed=0)
    assert isinstance(made, InjectedWorlds)
    return made


def test_worlds_of_a_leg_are_the_variant_that_verification_runs() -> None:
    """Step by step the same motion as `run_variant` gives, which computes the torques in lines of its own."""
    made = machine("leg", EXPLICIT)
    start = np.array([-0.5, 1.1])
    torque = np.tile([3.0, -1.5], (40, 1)) * np.sin(0.4 * np.arange(40))[:, None]
    leg = load_model("leg")
    prompt = replace(leg, actuators=replace(leg.actuators, delay_s=0.0))
    wanted = run_variant(prompt, EXPLICIT, torque, start=(start, np.zeros(2)), step=STEP_S)
    worlds = started("leg")
    qpos, qvel = np.zeros_like(worlds.qpos), np.zeros_like(worlds.qvel)
    qpos[:, made.places] = start
    worlds.put(np.ones(3, bool), qpos, qvel)
    for row, there in zip(torque, wanted.position, strict=True):
        np.testing.assert_allclose(worlds.qpos[:, made.places], np.tile(there, (3, 1)), atol=1e-9)
        worlds.ctrl[:] = row
        worlds.step()
    assert np.abs(wanted.position[-1] - start).max() > 0.02


def test_what_is_injected_is_not_in_the_file_and_the_rest_is() -> None:
    plain, made = machine("quadruped", "kin_only"), machine("quadruped", EXPLICIT)
    assert made.variant == EXPLICIT and plain.variant == "kin_only" and plain.injected is None
    knees = [f"{leg}_knee" for leg in ("fl", "rr")]
    for name in made.joints:
        more = made.mujoco.joint(name).damping - plain.mujoco.joint(name).damping
        assert more == pytest.approx(0.0972 if name.endswith("hip") else 0.0)  # Delta D_act, its diagonal
    assert all(made.mujoco.joint(name).armature == plain.mujoco.joint(name).armature for name in knees)
    np.testing.assert_array_equal(made.mujoco.tendon_armature, plain.mujoco.tendon_armature)


def test_a_restart_forgets_the_acceleration_a_state_keeps_it() -> None:
    worlds, made = started("quadruped"), machine("quadruped", EXPLICIT)
    qpos, qvel = np.array(worlds.qpos), np.zeros_like(worlds.qvel)
    qpos[:, 2] = made.height - 0.002
    qpos[:, made.places] = made.posture
    worlds.put(np.ones(3, bool), qpos, qvel)

    def steps(count: int) -> np.ndarray:
        for _ in range(count):
            worlds.ctrl[:] = 2.0
            worlds.step()
        return np.array(worlds.qvel)

    first = steps(3)
    kept = worlds.state()
    on = steps(3)
    worlds.put(np.array([True, False, True]), qpos, qvel)
    worlds.put(np.array([False, True, False]), qpos, qvel)
    np.testing.assert_allclose(steps(3), first, atol=1e-9)
    worlds.restore(kept)
    np.testing.assert_allclose(steps(3), on, atol=1e-6)


def test_the_world_that_judges_has_the_torques_too() -> None:
    """In short steps and slow motion injecting is nearly S3N-Full; without the torques it is not."""
    ends = {}
    for variant in ("s3n_full", EXPLICIT, "kin_only"):
        made = machine("quadruped", variant)
        m = made.mujoco.__copy__()
        m.opt.timestep = 0.0005
        plant = TrainedPlant(made, m)
        plant.reset(made.drive_position(made.posture), 1.0)  # in the air
        for k in range(30):  # knees bend: nearly stretched in the air, injecting would diverge
            plant.advance(np.tile([0.0, -2.0, 2.0], 4) * np.sin(0.2 * k))
        ends[variant] = plant.state().position
    full, injected, plain = (ends[v] for v in ("s3n_full", EXPLICIT, "kin_only"))
    assert np.abs(injected - full).max() < 0.3 * np.abs(plain - full).max()


def test_a_bundle_of_such_a_run_is_judged_with_its_torques(tmp_path: Path) -> None:
    pytest.importorskip("torch")
    from workbench.bundle import read_bundle
    from workbench.training.export import export
    from workbench.training.learn import learn
    from workbench.training.of_bundle import machine_of, robot_files
    from workbench.training.settings import Learning
    from workbench.training.tasks import TASKS

    few = Settings(worlds=8, iterations=1, threads=1, learning=Learning(rollout=4))
    learn(TASKS["circular"], machine("quadruped", EXPLICIT), few, tmp_path / "run", logger="none",
          extra={"record": None})  # fmt: skip
    bundle = read_bundle(export(tmp_path / "run", tmp_path / "bundle.zip"))
    assert bundle.variant == EXPLICIT
    again = machine_of(bundle, tmp_path / "unpacked")
    assert again.injected is not None and again.digest == machine("quadruped", EXPLICIT).digest
    assert not robot_files(bundle, tmp_path / "robot")  # no plain MJCF holds it


def test_a_limb_without_a_linkage_is_refused() -> None:
    with pytest.raises(InputError, match="parallelogram"):
        make_machine("leg", replace(load_model("leg_kin_only"), linkage=None), EXPLICIT)
    assert mujoco.MjModel.from_xml_string(machine("leg", EXPLICIT).xml).nq == 2
