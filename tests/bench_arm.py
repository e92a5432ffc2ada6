"""A three-axis arm as an MJCF with numbers to get wrong, and logs of it by MuJoCo alone in a loop."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np

from workbench.core import Controller, Recording

NUMBERS = {
    "yaw_x": 0.0, "yaw_y": 0.0, "yaw_z": 1.0, "turret_mass": 3.0, "turret_centre": 0.05, "upper_roll": 0.004,
    "yaw_armature": 0.12, "lift_armature": 0.0868, "bend_armature": 0.06,
    "yaw_damping": 0.5, "lift_damping": 0.8, "bend_damping": 0.4,
    "upper_mass": 2.4, "upper_centre": 0.17, "upper_inertia": 0.022,
    "fore_mass": 1.3, "fore_centre": 0.14, "fore_across": 0.0, "fore_inertia": 0.032, "fore_roll": 0.014,
    "bend_stiffness": 0.0, "bend_rest": 0.0,
    "yaw_friction": 0.0, "lift_friction": 0.0,
}  # fmt: skip
AXES = ("yaw", "lift", "bend")
_XML = """<mujoco><compiler angle="radian"/><option timestep="0.001" integrator="implicitfast"/><worldbody>
<body name="turret" pos="0 0 0.2">
 <joint name="yaw" axis="{yaw_x} {yaw_y} {yaw_z}" damping="{yaw_damping}" armature="{yaw_armature}"{yaw_dry}/>
 <inertial pos="0 0 {turret_centre}" mass="{turret_mass}" diaginertia="0.01 0.01 0.008"/>
 <body name="upper" pos="0 0 0.1">
  <joint name="lift" axis="0 1 0" damping="{lift_damping}" armature="{lift_armature}"{lift_dry}/>
  <inertial pos="{upper_centre} 0 0" mass="{upper_mass}"
   diaginertia="{upper_roll} {upper_inertia} {upper_inertia}"/>
  <body name="fore" pos="0.35 0 0">
   <joint name="bend" axis="0 1 0" damping="{bend_damping}" armature="{bend_armature}"
    stiffness="{bend_stiffness}" springref="{bend_rest}"/>
   <inertial pos="{fore_centre} 0 {fore_across}" mass="{fore_mass}"
    diaginertia="{fore_roll} {fore_inertia} {fore_inertia}"/>
   <site name="tip" pos="0.3 0 0"/>
  </body>
 </body>
</body></worldbody>
<actuator><motor joint="yaw"/><motor joint="lift"/><motor joint="bend"/></actuator>
</mujoco>"""
#: Dry friction that is as good as rigid in steps of a quarter of a millisecond.
_DRY = ' frictionloss="{}" solreffriction="0.002 1" solimpfriction="0.99 0.999 0.0001"'
KP, KD = np.array([120.0, 150.0, 80.0]), np.array([6.0, 8.0, 3.0])
#: Tones of each axis in one log: (amplitude [rad], frequency [Hz], phase).
SLOW = [(0.9, 0.11, 0.0), (0.2, 0.4, 1.0)], [(0.7, 0.13, 2.0), (0.15, 0.5, 0.0)], [(0.8, 0.17, 1.0)]
FAST = (
    [(0.3, 1.1, 0.0), (0.1, 2.3, 2.0)],
    [(0.3, 0.9, 1.0), (0.08, 2.1, 0.0)],
    [(0.3, 1.3, 2.0), (0.1, 2.6, 1.0)],
)


def bench_arm(folder: Path, name: str = "arm", **numbers: float) -> Path:
    """The MJCF with some of its `NUMBERS` changed."""
    file = folder / f"{name}.xml"
    every = {**NUMBERS, **numbers}
    dry = {
        f"{axis}_dry": _DRY.format(x) if (x := every[f"{axis}_friction"]) else "" for axis in ("yaw", "lift")
    }
    file.write_text(_XML.format(**every, **dry))
    return file


#: What was logged already, by the machine and what was asked of it: many tests begin with the same logs.
_LOGGED: dict[str, Recording] = {}


def logged(
    file: Path,
    tones: tuple = FAST,
    *,
    seconds: float = 10.0,
    log_s: float = 0.002,
    loop_s: float = 0.002,
    held: bool = True,
    positions_alone: bool = False,
    speed_noise: float = 0.0,
    differences: bool = False,
    resisting: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None,
    late: int = 0,
    lag: float = 0.0,
    pauses: bool = False,
    seed: int = 0,
) -> Recording:
    """What MuJoCo makes of an MJCF in a PD loop that has its speed from a sensor, or from `differences`.

    Args:
        file: the machine.
        tones: of each axis' reference.
        log_s, loop_s: periods of log and loop; `held`: the reference moves with the log's rows only.
        positions_alone: the log has positions and references.
        speed_noise: what the loop's sensor of speed adds at each tick [rad/s].
        resisting: torque (3,) of something else by position and speed.
        late: ticks by which the drives are late; `lag`: time constant of the lift's current [s].
        pauses: the reference rests for 0.8 s, again and again.
    """
    known = None
    if resisting is None and not lag:
        asked = (tones, seconds, log_s, loop_s, held, positions_alone, speed_noise, differences, late, pauses,
                 seed)  # fmt: skip
        known = f"{file.read_text()} {asked}"
        if known in _LOGGED:
            return _LOGGED[known]
    m = mujoco.MjModel.from_xml_path(str(file))
    m.opt.timestep, m.opt.integrator = 2.5e-4, mujoco.mjtIntegrator.mjINT_RK4
    data, generator, read = mujoco.MjData(m), np.random.default_rng(seed), np.random.default_rng([seed, 1])
    ticks = round(log_s / loop_s)
    count = int(seconds / log_s) * ticks

    def wanted(t: float) -> np.ndarray:
        if pauses:
            begun, moved = np.floor(t / 1.6), min(1.0, t % 1.6 / 0.8)
            t = 1.6 * (begun + 0.5 - 0.5 * np.cos(np.pi * moved))
        whole = [sum(a * np.sin(2 * np.pi * f * t + p) - a * np.sin(p) for a, f, p in axis) for axis in tones]
        return np.array(whole) * min(1.0, t)

    rows, before, coming = [], data.qpos.copy(), deque([np.zeros(3)] * late)
    given, slow = np.zeros(3), np.array([0.0, lag and np.exp(-m.opt.timestep / lag), 0.0])
    for k in range(count):
        reference = wanted((k // ticks) * log_s if held else k * loop_s)
        q, w = data.qpos.copy(), data.qvel.copy()
        speed = (q - before) / loop_s if differences else w + read.normal(0.0, speed_noise, 3)
        torque, before = KP * (reference - q) - KD * speed, q
        coming.append(torque)
        wants = coming.popleft()
        given = np.where(slow > 0.0, given, wants)
        if k % ticks == 0:
            noise = generator.normal(0.0, 1.0, (3, 3)) * [[5e-5], [2e-3], [0.02]]
            rows.append((q + noise[0], w + noise[1], torque, given + noise[2], reference))
        steps = round(loop_s / m.opt.timestep)
        data.qfrc_applied[:] = given
        if resisting is None and not lag:
            mujoco.mj_step(m, data, steps)
            continue
        for _ in range(steps):
            data.qfrc_applied[:] = given + (resisting(data.qpos, data.qvel) if resisting else 0.0)
            mujoco.mj_step(m, data)
            given = wants + slow * (given - wants)
    names = "position", "velocity", "torque_command", "torque_measured", "position_reference"
    signals = {name: np.stack([row[k] for row in rows]) for k, name in enumerate(names)}
    loop = Controller("pd", "joint", kp=tuple(KP), kd=tuple(KD), period_s=loop_s)
    derived: tuple[str, ...] = ()
    if positions_alone:
        for name in ("torque_command", "torque_measured"):
            del signals[name]
        signals["velocity"] = np.gradient(signals["position"], log_s, axis=0)
        derived = ("velocity",)
    t = log_s * np.arange(len(rows))
    made = Recording(f"log_{seed}", AXES, "joint", t, signals, ("rad",) * 3, loop, derived=derived)
    if known is not None:
        _LOGGED[known] = made
    return made
