"""The study of a measured six-axis arm: its model by hand, and its logs read."""

from pathlib import Path

import mujoco
import numpy as np
import ur10e

from workbench import load_model, load_recordings
from workbench.effects import compile_plant

#: Reach of the stretched arm by its Denavit-Hartenberg parameters: a2 + a3, d4 + d6, d1 - d5 [m].
_FLANGE = (-0.6127 - 0.57155, -0.17415 - 0.11655, 0.1807 - 0.11985)


def test_the_stretched_arm_reaches_and_weighs_as_its_maker_says() -> None:
    plant = compile_plant(load_model("ur10e")).mujoco
    data = mujoco.MjData(plant)
    mujoco.mj_inverse(plant, data)
    np.testing.assert_allclose(data.site("flange").xpos, _FLANGE, atol=1e-9)
    wrists = 2.1 + 1.98 + 0.615
    moment = 13.051 * (0.6127 - 0.38) + 3.989 * (0.6127 + 0.57155 - 0.24) + wrists * (0.6127 + 0.57155)
    np.testing.assert_allclose(data.qfrc_inverse[1], -9.81 * moment, rtol=1e-3)


def test_a_log_becomes_a_recording_of_joint_torques(tmp_path: Path) -> None:
    random = np.random.default_rng(0)
    log = random.standard_normal((40, 31))
    log[:, 0] = 838.4 + 0.01 * np.arange(40)
    np.savetxt(tmp_path / "log.csv", log, delimiter=",", fmt="%.4f")
    [r] = load_recordings([ur10e.recorded(tmp_path / "log", tmp_path / "out")])
    assert r.axes == ur10e.AXES and r.controller.kind == "unknown"
    np.testing.assert_allclose(r.position, log[:, 1:7], atol=1e-4)
    np.testing.assert_allclose(r.signals["torque_measured"], log[:, 13:19] * ur10e.TORQUE_CONSTANT, atol=1e-3)


def test_the_authors_friction_is_held_at_the_same_constants(tmp_path: Path) -> None:
    triples = " ".join("20 10 0.1" for _ in ur10e.AXES)
    text = (
        f"pi_frcn - friction\ndrvGains = [{' '.join('10' for _ in ur10e.AXES)}];\n\npi_frcn = [{triples}]\n"
    )
    (tmp_path / "p.txt").write_text(text)
    found = ur10e.authors_friction(tmp_path / "p.txt")
    assert found is not None
    np.testing.assert_allclose(found, np.outer(ur10e.TORQUE_CONSTANT, [1.0, 2.0]))
    assert ur10e.authors_friction(tmp_path / "none.txt") is None
