"""A hinge that carries a slide, with dry friction that its MJCF states, and logs of it by MuJoCo alone."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from workbench.core import Controller, Recording

LOSS = {"lift": 0.6, "reach": 4.0}  # N m, N
#: MuJoCo's own constraint, made so stiff that steps of 0.1 ms see it as rigid.
RIGID = 'solreffriction="0.0002 1" solimpfriction="0.99 0.99"'
ON_TENDONS = "".join(
    f'<fixed name="seal_{name}" frictionloss="{loss}" {{how}}><joint joint="{name}" coef="1"/></fixed>'
    for name, loss in LOSS.items()
)
_XML = """<mujoco><compiler angle="radian"/><option timestep="0.002" integrator="{integrator}"/><worldbody>
<body pos="0 0 1"><joint name="lift" axis="0 -1 0" damping="0.3" armature="0.05" {lift}/>
 <inertial pos="0.1 0 0" mass="2" diaginertia="0.004 0.02 0.02"/><site name="hub" pos="0 0.05 0"/>
 <body pos="0.2 0 0"><joint name="reach" type="slide" axis="1 0 0" damping="2" armature="0.3" {reach}/>
  <inertial pos="0.05 0 0" mass="1" diaginertia="0.001 0.002 0.002"/><site name="tip" pos="0.1 0 0"/></body>
</body><site name="post" pos="-0.1 0 1.3"/></worldbody><tendon>{tendon}</tendon></mujoco>"""
_PERIOD, _STEP = 0.002, 1e-4  # s
_LOOP = Controller("pd", "joint", kp=(80.0, 6000.0), kd=(4.0, 120.0), period_s=_PERIOD)


def dry_arm(
    folder: Path, where: str = "joint", how: str = "", integrator: str = "implicitfast", name: str = "dry"
) -> Path:
    """The MJCF with friction at its joints or on ``fixed`` tendons, or `where` ``none``; `how` soft it is."""
    joints = {k: f'frictionloss="{v}" {how}' if where == "joint" else "" for k, v in LOSS.items()}
    tendon = ON_TENDONS.format(how=how) if where == "fixed" else ""
    file = folder / f"{name}.xml"
    file.write_text(_XML.format(integrator=integrator, tendon=tendon, **joints))
    return file


def made(file: Path, seconds: float = 6.0, seed: int = 0, step: float = _STEP) -> Recording:
    """What MuJoCo alone makes of the MJCF in a PD loop, with noise on its sensors."""
    m = mujoco.MjModel.from_xml_path(str(file))
    m.opt.timestep, m.opt.integrator = step, mujoco.mjtIntegrator.mjINT_RK4
    data, generator = mujoco.MjData(m), np.random.default_rng(seed)
    t = np.arange(0.0, seconds, _PERIOD)
    tones = [(0.5, 0.4, 0.0), (0.2, 1.3, 1.0)], [(0.12, 0.6, 2.0), (0.04, 1.7, 0.0)]
    reference = np.stack(
        [sum(a * np.sin(2 * np.pi * f * t + p) for a, f, p in axis) for axis in tones], axis=1
    )
    reference -= reference[0]
    rows = []
    for wanted in reference:
        q = data.qpos + generator.normal(0.0, (1e-4, 1e-5))
        w = data.qvel + generator.normal(0.0, (5e-3, 5e-4))
        torque = np.array(_LOOP.kp) * (wanted - q) - np.array(_LOOP.kd) * w
        rows.append((q, w, torque, torque + generator.normal(0.0, (0.03, 0.3))))
        data.qfrc_applied[:] = torque
        mujoco.mj_step(m, data, round(_PERIOD / step))
    names = "position", "velocity", "torque_command", "torque_measured"
    signals = {name: np.stack([row[k] for row in rows]) for k, name in enumerate(names)}
    signals["position_reference"] = reference
    return Recording(f"made_{seed}", ("lift", "reach"), "joint", t, signals, ("rad", "m"), _LOOP)
