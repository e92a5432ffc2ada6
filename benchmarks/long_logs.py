"""Long logs of a simulated machine: four legs of three axes on a stand, one of which rubs.

Bodies, drives, loop and sensors are simulated without a break from the first row to the last, and written
piece by piece, so that a log may be longer than memory.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import pyarrow as pa
import pyarrow.csv as pacsv
import pyarrow.parquet as pq
import tomli_w

LEGS = "fl", "fr", "rl", "rr"
JOINTS = "abduction", "hip", "knee"
ROW_S, TICK_ROWS, DELAY_ROWS = 0.001, 3, 3
_STEPS = 4  # of the simulation, a row
_PIECE_S = 20.0
_KP, _KD = 50.0, 1.5
_ENCODER, _RATE_STD, _TORQUE_STD = 2 * np.pi / 2**16, 0.02, 0.02
_ROTOR, _DAMPING = 0.01, 0.1
_SIGNALS = {"position": "q", "velocity": "w", "torque_command": "cmd", "torque_measured": "tau",
            "position_reference": "qref"}  # fmt: skip


@dataclass(frozen=True)
class Rubbing:
    """What is hidden: dry friction of one axis [N m]."""

    axis: str = "rl_knee"
    torque: float = 0.4


def axes_of(legs: int = 4) -> tuple[str, ...]:
    """Names of the axes."""
    return tuple(f"{leg}_{joint}" for leg in LEGS[:legs] for joint in JOINTS)


def write_model(folder: Path, legs: int = 4) -> Path:
    """The model that is believed: bodies and drives as they are, without what is hidden; returns its file."""
    (folder / "legs.xml").write_text(_bodies(legs, None))
    axes = list(axes_of(legs))
    content = {
        "format": 1, "name": "legs", "serial": "legs.xml", "axes": axes,
        "actuators": {"inertia": [_ROTOR] * len(axes), "damping": [_DAMPING] * len(axes),
                      "torque_limit": 40.0, "delay_s": DELAY_ROWS * ROW_S},
    }  # fmt: skip
    path = folder / "legs.toml"
    path.write_text(tomli_w.dumps(content))
    return path


def write_log(
    folder: Path, name: str, duration: float, *, legs: int = 4, seed: int = 0, table: str = "parquet",
    hidden: Rubbing | None = Rubbing(),
) -> Path:  # fmt: skip
    """Simulate and write a recording; returns its TOML file.

    Args:
        folder: where to.
        name: of the recording.
        duration: of the log [s].
        legs: how many of the four, three axes each.
        seed: of references and sensors.
        table: ``"parquet"`` or ``"csv"``.
        hidden: in the machine; None for nothing.
    """
    axes, path = axes_of(legs), folder / f"{name}.{table}"
    columns = ["t", *(f"{short}_{axis}" for short in _SIGNALS.values() for axis in axes)]
    schema = pa.schema([(column, pa.float64()) for column in columns])
    machine = _Machine(legs, seed, hidden)
    rows, piece = round(duration / ROW_S), round(_PIECE_S / ROW_S)
    open_ = pq.ParquetWriter if table == "parquet" else pacsv.CSVWriter
    with open_(path, schema) as out:
        for start in range(0, rows, piece):
            block = machine.run(start, min(piece, rows - start))
            out.write_table(pa.table([pa.array(x) for x in block.T], schema=schema))
    content = {
        "format": 1, "name": name, "table": path.name, "rig": "legs", "coordinates": "actuator",
        "axes": list(axes),
        "columns": {"time": "t"} | {s: [f"{short}_{axis}" for axis in axes] for s, short in _SIGNALS.items()},
        "controller": {"kind": "pd", "coordinates": "actuator", "kp": [_KP] * len(axes),
                       "kd": [_KD] * len(axes), "period_s": TICK_ROWS * ROW_S},
        "excitation": {"kind": "reference"},
    }  # fmt: skip
    description = folder / f"{name}.toml"
    description.write_text(tomli_w.dumps(content))
    return description


class _Machine:
    """Bodies, drives, loop and sensors, from one row to the next."""

    def __init__(self, legs: int, seed: int, hidden: Rubbing | None) -> None:
        self.model = mujoco.MjModel.from_xml_string(_bodies(legs, hidden, driven=True))
        self.data = mujoco.MjData(self.model)
        n = self.model.nv
        generator = np.random.default_rng([seed, n])
        # incommensurate tones, so that the motion never repeats
        self.hertz = generator.uniform(0.1, 3.0, (4, n))
        self.phase = generator.uniform(0.0, 2 * np.pi, (4, n))
        self.size = 0.12 / np.sqrt(self.hertz / 0.1)
        self.noise = generator
        self.data.qpos[:] = self.reference(np.zeros(1))[0]
        self.queue = [np.zeros(n)] * DELAY_ROWS
        self.command = np.zeros(n)

    def reference(self, t: np.ndarray) -> np.ndarray:
        """Wanted positions (N, n) [rad], at rest at the origin of time."""
        waves = np.sin(2 * np.pi * self.hertz * t[:, None, None] + self.phase) - np.sin(self.phase)
        return np.sum(self.size * waves, axis=1)

    def run(self, start: int, rows: int) -> np.ndarray:
        """The next rows of the log, (rows, columns)."""
        m, d, n = self.model, self.data, self.model.nv
        t = ROW_S * np.arange(start, start + rows)
        wanted = self.reference(t)
        jitter = self.noise.standard_normal((2, rows, n))
        q, w, command, torque = (np.empty((rows, n)) for _ in range(4))
        for k in range(rows):
            q[k] = np.round(d.qpos / _ENCODER) * _ENCODER
            w[k] = d.qvel + _RATE_STD * jitter[0, k]
            if (start + k) % TICK_ROWS == 0:
                self.command = _KP * (wanted[k] - q[k]) - _KD * w[k]
            self.queue.append(self.command)
            d.ctrl[:] = np.clip(self.queue.pop(0), -40.0, 40.0)
            command[k], torque[k] = self.command, d.ctrl + _TORQUE_STD * jitter[1, k]
            mujoco.mj_step(m, d, _STEPS)
        return np.hstack([t[:, None], q, w, command, torque, wanted])


def _bodies(legs: int, hidden: Rubbing | None, *, driven: bool = False) -> str:
    """MJCF of the legs; `driven` with rotors and motors, as the machine has them."""

    def joint(leg: str, name: str, axis: str) -> str:
        rubs = hidden is not None and hidden.axis == f"{leg}_{name}"
        rubbing = f' frictionloss="{hidden.torque}"' if rubs and hidden else ""
        drive = f' armature="{_ROTOR}" damping="{_DAMPING}"' if driven else ""
        return f'<joint name="{leg}_{name}" type="hinge" axis="{axis}"{drive}{rubbing}/>'

    parts = []
    for k, leg in enumerate(LEGS[:legs]):
        x, y = (0.25, -0.25)[k // 2], (0.1, -0.1)[k % 2]
        parts.append(f"""
    <body name="{leg}_shoulder" pos="{x} {y} 0.8">{joint(leg, "abduction", "1 0 0")}
      <inertial pos="0 0.03 0" mass="0.6" diaginertia="0.001 0.001 0.001"/>
      <body name="{leg}_upper" pos="0 0.06 0">{joint(leg, "hip", "0 1 0")}
        <inertial pos="0 0 -0.08" mass="1.1" diaginertia="0.006 0.006 0.001"/>
        <body name="{leg}_lower" pos="0 0 -0.22">{joint(leg, "knee", "0 1 0")}
          <inertial pos="0 0 -0.1" mass="0.4" diaginertia="0.002 0.002 0.0003"/>
        </body>
      </body>
    </body>""")
    motors = "".join(f'<motor joint="{axis}"/>' for axis in axes_of(legs)) if driven else ""
    return f"""<mujoco model="legs">
  <option timestep="{ROW_S / _STEPS}" integrator="implicitfast"/>
  <worldbody>{"".join(parts)}
  </worldbody>
  <actuator>{motors}</actuator>
</mujoco>
"""
