"""A log that position actuators of the model's file made has their gains; another one is told of them."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from workbench import import_table
from workbench.comparison import compare

_ARM = """<mujoco model="arm"><compiler angle="radian"/><option timestep="0.002" integrator="{integrator}"/>
<worldbody>
<body><joint name="lift" axis="0 1 0" armature="0.1" damping="0.5" frictionloss="0.1"/>
<geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03" mass="1" contype="0"/>
<body pos="0.3 0 0"><joint name="elbow" axis="0 1 0" armature="0.05" damping="0.2"/>
<geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.03" mass="0.5" contype="0"/></body></body></worldbody>
<actuator><position joint="lift" kp="90" kv="{kv}"/><position joint="elbow" kp="40" kv="3"/></actuator>
</mujoco>"""


def log(folder: Path, *, kv: float = 6.0, integrator: str = "Euler") -> Path:
    """Ten seconds of a simulation by whoever has the file, at every second step of it."""
    m = mujoco.MjModel.from_xml_string(_ARM.format(kv=kv, integrator=integrator))
    d, rng, rows = mujoco.MjData(m), np.random.default_rng(1), []
    for k in range(5000):
        t = 0.002 * k
        d.ctrl[:] = 0.4 * np.sin(2.0 * t) - 0.4, 0.5 * np.sin(3.1 * t) * min(1.0, t)
        q, w = d.qpos + rng.normal(0.0, 1e-5, 2), d.qvel + rng.normal(0.0, 1e-3, 2)
        mujoco.mj_step(m, d)
        if k % 2 == 0:
            rows.append([t, *q, *d.ctrl, *w, *(d.actuator_force + rng.normal(0.0, 0.01, 2))])
    names = [
        f"{signal}_{axis}" for signal in ("pos", "target", "vel", "torque") for axis in ("lift", "elbow")
    ]
    np.savetxt(folder / "log.csv", rows, delimiter=",", header=",".join(["time", *names]), comments="")
    (folder / "arm.xml").write_text(_ARM.format(kv=6.0, integrator=integrator))
    return folder / "log.csv"


def test_gains_of_the_file_are_taken_if_the_torque_obeys(tmp_path: Path) -> None:
    loop = import_table(log(tmp_path), tmp_path / "arm.xml", likeliest=True).controller
    assert (loop.kind, loop.kp, loop.kd, loop.period_s) == ("pd", (90.0, 40.0), (6.0, 3.0), 0.002)


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast"])
def test_the_file_explains_what_it_made(tmp_path: Path, integrator: str) -> None:
    """Implicit integrators are so in the actuators' gains on speed too."""
    made = import_table(log(tmp_path, integrator=integrator), tmp_path / "arm.xml", likeliest=True)
    found = compare(tmp_path / "arm.xml", made)
    assert found.consistent and any("stepped = true" in note for note in found.notes)


def test_other_gains_are_not(tmp_path: Path) -> None:
    loop = import_table(log(tmp_path, kv=12.0), tmp_path / "arm.xml", likeliest=True).controller
    assert loop.kind == "unknown"
