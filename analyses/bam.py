"""A hobby servo that lifts a pendulum: what its model lacks, judged at a gain that was not fitted.

    python analyses/bam.py data/bam_xl330 --output out/bam

Logs of Rhoban/bam (Apache-2.0): an XL330 with a position gain on its duty cycle, a pendulum of 0.49 kg at
0.1 m. The model is a motor by its published constants (kt 0.323 N m/A, R 4.76 ohm) and the pendulum; runs at
the held-out gain judge. Published: friction beyond Coulomb and viscous that grows with the load, a duty cycle
that ends at 885 counts, a supply that sags. Beside the diagnosis, sets of effects are fitted and judged.
The torque is taken at the nominal supply, whose sag the model has not: what is found is to be read with that.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
import tomli_w
from rich.table import Table

from workbench import improve, load_model, load_recordings, report
from workbench.core import EffectKey, Recording
from workbench.core.files import write_whole
from workbench.diagnosis.data import gather
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.hypothesis import Hypothesis, applied_effect
from workbench.models import AppliedEffect, Model

_KT, _OHM, _VOLTS, _FULL = 0.323, 4.76, 7.4, 885.0
_ARMATURE, _TICKS, _GAIN_UNIT = 0.00164, 4096 / (2.0 * np.pi), 256.0
_STALL = _KT / _OHM * _VOLTS  # N m at full duty cycle and nominal supply
_RATE_GAIN = 1e-4  # N m s/rad, a hundredth of the damping

_MJCF = """<mujoco model="pendulum">
  <compiler angle="radian"/>
  <worldbody><body name="arm">
    <joint name="servo" axis="0 -1 0" armature="{armature}" damping="{damping}"/>
    <inertial pos="0 0 -0.1" mass="0.49" diaginertia="1e-5 1e-5 1e-5"/>
    <site name="load" pos="0 0 -0.1"/>
  </body></worldbody>
</mujoco>
"""


def write_bam_model(folder: Path) -> Path:
    """The servo as its data sheet has it: inertia, back-EMF as damping, no friction; gives its TOML."""
    arm = _MJCF.format(armature=_ARMATURE, damping=_KT**2 / _OHM)
    write_whole(folder / "pendulum.xml", arm, force=True)
    text = tomli_w.dumps(
        {
            "format": 1,
            "name": "servo",
            "serial": "pendulum.xml",
            "axes": ["servo"],
            "payload": {"site": "load"},
        }
    )
    write_whole(folder / "servo.toml", text, force=True)
    return folder / "servo.toml"


def write_bam_recording(log: Path, folder: Path) -> Path:
    """A log as a table and its TOML; the torque is what the logged duty cycle asks of the motor at rest."""
    raw = json.loads(log.read_text())
    rows = raw["entries"]
    # where the servo is switched off nothing is asked of it, and the loop is another
    on = next((k for k, e in enumerate(rows) if not e["torque_enable"]), len(rows))
    rows = rows[:on]
    duty = np.array([e["load"] for e in rows], float)
    duty = np.where(duty > 32767, duty - 65536, duty) / _FULL
    t = np.array([e["timestamp"] for e in rows])
    columns = {
        "t": t - t[0],
        "position": np.array([e["position"] for e in rows]),
        "goal": np.array([e["goal_position"] for e in rows]),
        "torque": duty * _STALL,
        "volts": np.array([e["input_volts"] for e in rows]),
    }
    lines = [
        ",".join(columns),
        *(",".join(f"{x:.9g}" for x in row) for row in zip(*columns.values(), strict=True)),
    ]
    write_whole(folder / f"{log.stem}.csv", "\n".join(lines) + "\n", force=True)
    gain = raw["kp"] / _GAIN_UNIT * _TICKS / _FULL * _STALL
    text = tomli_w.dumps(
        {
            "format": 1,
            "name": log.stem,
            "table": f"{log.stem}.csv",
            "rig": "servo",
            "axes": ["servo"],
            "columns": {
                "time": "t",
                "position": "position",
                "position_reference": "goal",
                "torque_command": "torque",
                "voltage": "volts",
            },
            # a duty cycle ends before it is logged: a cascade has such a limit; its gain on speed is tiny
            "controller": {
                "kind": "cascade_pv",
                "kp": [gain / _RATE_GAIN],
                "kv": [_RATE_GAIN],
                "gain": [1.0],
                "limit": [_STALL],
                "period_s": 0.001,  # the servo's own loop, faster than its log
            },
            "timing": {"initial_at_rest": False},
        }
    )
    write_whole(folder / f"{log.stem}.toml", text, force=True)
    return folder / f"{log.stem}.toml"


_START = {  # where fits begin
    "coulomb_friction": {"torque": 0.03},
    "viscous_damping": {"damping": 0.01},
    "load_dependent_friction": {"torque": 0.02, "ratio": 0.3},
    "torque_constant_error": {"gain": 1.2},
}
_SETS = (
    (),
    ("coulomb_friction", "viscous_damping"),
    ("coulomb_friction", "viscous_damping", "torque_constant_error"),
    ("load_dependent_friction", "viscous_damping"),
    ("load_dependent_friction", "viscous_damping", "torque_constant_error"),
)


def fitted(model: Model, training: list[Recording], judge: list[Recording], seed: int) -> Table:
    """Given sets of effects, fitted at the other gains: their position error at the held-out one."""
    table = Table("effects", "fitted [rad]", "held out [rad]", "parameters")
    data, _ = gather(model, training, judge, seed)
    sets = [tuple(_applied(model, name) for name in names) for names in _SETS]
    for names, found in zip(_SETS, fit([Hypothesis(model, s) for s in sets], data), strict=True):
        if found is None:
            continue
        values = [f"{k} {v:.3g}" for a in found.hypothesis.free for k, v in a.values.items()]
        errors = [np.sqrt(data.pool(found.mean_squares, part)[0, 0]) for part in (False, True)]
        table.add_row(", ".join(names) or "none", *(f"{e:.4f}" for e in errors), ", ".join(values))
    return table


def _applied(model: Model, name: str) -> AppliedEffect:
    return applied_effect(model, AppliedEffect(EffectKey(name, "servo")), _START[name])


def main() -> None:
    """Improve the motor's model at some gains, judge at another."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path, help="folder of the JSON logs")
    parser.add_argument("--hold-out", type=int, default=200, choices=(100, 200, 800), help="gain that judges")
    parser.add_argument("--output", type=Path, default=Path("out/bam"))
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    folder: Path = arguments.output
    model = load_model(str(write_bam_model(folder)))
    logs = sorted(p for p in arguments.folder.glob("kp*.json") if not p.stem.endswith("lift_and_drop"))
    recordings = load_recordings([write_bam_recording(p, folder) for p in logs])
    judge = [r for r in recordings if r.name.startswith(f"kp{arguments.hold_out}_")]
    training = [r for r in recordings if r not in judge]
    result, _ = improve(model, training, judge, seed=arguments.seed)
    report.print_table(report.improvement_table(result))
    report.print_table(fitted(model, training, judge, arguments.seed))
    report.save_figure(report.ladder_figure(result), folder / "error_falling.png", force=True)


if __name__ == "__main__":
    main()
