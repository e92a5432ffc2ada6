"""An arm of two axes that MuJoCo simulates from its own file, as a first try of a log often is."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import numpy as np

_FILE = """<mujoco model="arm"><compiler angle="radian"/><option timestep="{step}" integrator="Euler"/>
<worldbody><body pos="0 0 0.3">
<joint name="lift" axis="0 1 0" armature="0.15" damping="{damping}" frictionloss="{friction}"/>
<inertial pos="0.17 0 0" mass="2.2" diaginertia="0.002 0.03 0.03"/>
<body pos="0.35 0 0"><joint name="elbow" axis="0 1 0" armature="0.06" damping="0.3" frictionloss="0.2"/>
<inertial pos="0.15 0 0" mass="1.1" diaginertia="0.001 0.01 0.01"/><site name="tool" pos="0.3 0 0"/>
</body></body></worldbody></mujoco>"""
_AXES = ["lift", "elbow"]
_KP, _KD = np.array([250.0, 100.0]), np.array([14.0, 5.0])
_PERIOD = 0.002  # s, of rows and ticks
_SIGNALS = ("position", "position_reference", "velocity", "torque_command", "torque_measured")


def arm_file(folder: Path, *, step: float = 0.002, damping: float = 0.8, friction: float = 0.4) -> Path:
    """The arm's MJCF, with MuJoCo's usual soft friction."""
    file = folder / f"arm_{step:g}_{damping:g}_{friction:g}.xml"
    file.write_text(_FILE.format(step=step, damping=damping, friction=friction))
    return file


def mujoco_log(plant: Path, name: str, *, seed: int, step: float | None = None, loop: bool = True) -> Path:
    """A recording of 6 s, with noise, of the plant in MuJoCo's steps; without `loop`, its loop is unknown."""
    m = mujoco.MjModel.from_xml_path(str(plant))
    m.opt.timestep = step or m.opt.timestep
    d, rng = mujoco.MjData(m), np.random.default_rng(seed)
    f, p = rng.uniform(0.1, 1.1, (2, 5, 2)) * np.array([1.0, 6.0])[:, None, None]
    part = rng.uniform(0.3, 1.0, (5, 2))
    each, torque, rows = round(_PERIOD / m.opt.timestep), np.zeros(2), []

    def reference(t: float) -> np.ndarray:
        wave = (part / part.sum(axis=0) * np.sin(2 * np.pi * f * t + p)).sum(axis=0)
        return np.array([-0.3, 0.6]) + min(1.0, t) * np.array([0.5, 0.7]) * wave

    d.qpos[:] = reference(0.0)
    mujoco.mj_forward(m, d)
    for k in range(round(6.0 / m.opt.timestep)):
        if k % each == 0:
            t, position = d.time, d.qpos + rng.normal(0.0, 2e-5, 2)
            speed = d.qvel + rng.normal(0.0, 2e-3, 2)
            torque = _KP * (reference(t) - position) - _KD * speed
            tap = torque + rng.normal(0.0, 0.02, 2)
            rows.append(np.concatenate([[t], position, reference(t), speed, torque, tap]))
        d.qfrc_applied[:] = torque
        mujoco.mj_step(m, d)
    columns = {signal: [f"{signal}_{axis}" for axis in _AXES] for signal in _SIGNALS}
    header = ",".join(["t", *(c for names in columns.values() for c in names)])
    np.savetxt(plant.with_name(f"{name}.csv"), np.array(rows), delimiter=",", header=header, comments="")
    lines = [f'format = 1\nname = "{name}"\ntable = "{name}.csv"\nrig = "simulation"\ncoordinates = "joint"']
    lines += [f"axes = {json.dumps(_AXES)}", '[columns]\ntime = "t"']
    lines += [f"{signal} = {json.dumps(names)}" for signal, names in columns.items()]
    stated = f'kind = "pd"\ncoordinates = "joint"\nkp = {_KP.tolist()}\nkd = {_KD.tolist()}'
    lines += ["[controller]", f"{stated}\nperiod_s = {_PERIOD}" if loop else 'kind = "unknown"']
    file = plant.with_name(f"{name}.toml")
    file.write_text("\n".join(lines) + "\n")
    return file
