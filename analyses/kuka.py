"""What two encoders per axis say of a robot's gears: compliance, and the clock between the encoders.

    python analyses/kuka.py data/kuka_kr300/run_A.mat --output out/kuka

A log of JonasWeigand/Robot_Identification (MIT): a KUKA KR300, 250 Hz, 10 s. The second encoder of axes 1
to 3 sits behind the gear. Its difference from the motor's is held against the torque that passes the gear,
which is the motor's less what turns its rotor, beside a delay between the encoders and friction, for which it
could be mistaken. Each fifth of the record is left out in turn: it says how far the numbers move, and judges
whether torque and delay help.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from rich.table import Table
from scipy.io import loadmat
from scipy.signal import butter, sosfiltfilt

from workbench import report

_RATE, _BAND, _EDGE, _FOLDS = 250.0, 15.0, 50, 5


def read(path: Path) -> dict[str, np.ndarray]:
    """Signals of axes 1 to 3 at the joint, (N, 3) each, SI, and the authors' parameters (3,)."""
    raw = loadmat(path, squeeze_me=True, struct_as_record=False)
    log, para = raw["rec"], raw["para"]
    gear = para.u[:3]
    motor = np.deg2rad(log.act_pos_mot_deg.T[:, :3])
    return {
        "motor": motor,
        "twist": np.deg2rad(log.act_pos_se_deg.T[:, :3]) - motor,
        "speed": np.deg2rad(log.act_vel_mot_deg_per_s.T[:, :3]),
        "torque": log.act_torque_abs_nm.T[:, :3] * gear,
        "rotor": para.J_mr[:3] * gear**2,
        "stiffness": np.array(para.c_rad_ode[:3], float),
    }


def columns(log: dict[str, np.ndarray], axis: int) -> tuple[np.ndarray, np.ndarray]:
    """Twist (N,) and what may cause it (N, 5): torque through the gear, delay, friction, two offsets."""
    speed, position = log["speed"][:, axis], log["motor"][:, axis]
    through = log["torque"][:, axis] - log["rotor"][axis] * np.gradient(speed, 1.0 / _RATE)
    sign = np.tanh(speed / (0.02 * speed.std()))
    x = np.stack([-through, -speed, sign, np.ones_like(speed), position], axis=1)
    sos = butter(4, _BAND, fs=_RATE, output="sos")
    inside = slice(_EDGE, -_EDGE)
    return sosfiltfilt(sos, log["twist"][:, axis])[inside], sosfiltfilt(sos, x, axis=0)[inside]


def judged(y: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Coefficients (k,), their deviations by the jackknife over folds, and the rms error on left-out data."""
    folds = np.array_split(np.arange(len(y)), _FOLDS)
    each, left = [], 0.0
    for fold in folds:
        rest = np.setdiff1d(np.arange(len(y)), fold)
        each.append(np.linalg.lstsq(x[rest], y[rest], rcond=None)[0])
        left += float(np.sum((y[fold] - x[fold] @ each[-1]) ** 2))
    moves = np.array(each) - np.mean(each, axis=0)
    deviation = np.sqrt((_FOLDS - 1) / _FOLDS * np.sum(moves**2, axis=0))
    return np.linalg.lstsq(x, y, rcond=None)[0], deviation, np.sqrt(left / len(y))


def interval(compliance: float, deviation: float) -> str:
    """95 % interval of the stiffness from that of the compliance [N m/rad]."""
    low, high = compliance - 2.0 * deviation, compliance + 2.0 * deviation
    if high <= 0:
        return "none: the sign is wrong"
    return f"{1 / high:.2g} to {1 / low:.2g}" if low > 0 else f"above {1 / high:.2g}"


def main() -> None:
    """Fit, judge, print and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("table", type=Path, help="run_A.mat")
    parser.add_argument("--output", type=Path, default=Path("out/kuka"))
    arguments = parser.parse_args()
    log = read(arguments.table)
    found = Table("axis", "stiffness", "95 %", "published [N m/rad]", "delay [ms]")
    errors = Table("axis", "left-out error [urad]", "without torque", "without delay and friction")
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.6), layout="constrained")
    for i, ax in enumerate(axes):
        y, x = columns(log, i)
        whole, deviation, error = judged(y, x)
        rigid, loose = judged(y, x[:, 1:])[2], judged(y, np.delete(x, (1, 2), axis=1))[2]
        value = f"{1 / whole[0]:.2g}" if whole[0] > 0 else "-"
        delay = f"{1e3 * whole[1]:.2f} ± {2e3 * deviation[1]:.2f}"
        limits = interval(whole[0], deviation[0])
        found.add_row(str(i + 1), value, limits, f"{log['stiffness'][i]:.3g}", delay)
        errors.add_row(str(i + 1), *(f"{1e6 * e:.0f}" for e in (error, rigid, loose)))
        rest = y - x[:, 1:] @ whole[1:]
        ax.plot(1e-3 * -x[:, 0], 1e6 * rest, ".", ms=2, color="0.6", label="measured")
        ax.plot(1e-3 * -x[:, 0], 1e6 * whole[0] * x[:, 0], color="C0", label="fitted")
        ax.plot(1e-3 * -x[:, 0], 1e6 * x[:, 0] / log["stiffness"][i], color="C3", label="published")
        ax.set(
            title=f"axis {i + 1}", xlabel="torque through the gear [kN m]", ylabel="twist, less delay [urad]"
        )
    axes[0].legend()
    report.print_table(found)
    report.print_table(errors)
    report.save_figure(figure, arguments.output / "compliance.png", force=True)


if __name__ == "__main__":
    main()
