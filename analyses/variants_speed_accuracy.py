"""Every variant of S3N against the closed chain: error of motion and torque, cost of a step, longest step.

    python analyses/variants_speed_accuracy.py -o out/variants

A chirp is tracked by the leg's own joint loop, once by the closed chain (the links from Drake, rotors and
damping on the drives) and once by each variant. Plain variants are timed as the normalised file that
`workbench normalize` writes, alternating, so that a busy machine disturbs all alike.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator
from rich.table import Table

from workbench import load_model, report
from workbench.core import SimulationError
from workbench.core.files import write_whole
from workbench.models import VARIANTS, Model
from workbench.report.layout import table as new_table
from workbench.rigs import leg_structure
from workbench.s3n import VARIANT_NAMES, ConstraintSettings, VariantRun, normalise, run_variant
from workbench.s3n.loop import loop_spec
from workbench.s3n.runner import Law
from workbench.s3n.variants import PER_STEP
from workbench.s3n.worlds import make_world

HOLD = np.array([-0.55, np.pi / 3])  # joint coordinates [rad]
PERIOD, SECONDS = 0.003, 6.0
STEPS = (0.0005, 0.001, 0.0015, 0.003)  # of the motion [s], whole parts of the period
LONGEST = (0.003, 0.004, 0.005, 0.006, 0.008, 0.010, 0.012, 0.015, 0.020)  # control period = step [s]
STIFF = ConstraintSettings(solref=(0.006, 1.0), solimp=(0.99, 0.999, 0.001, 0.5, 2.0))
#: Row of the table -> variant and settings of its loop.
ROWS: dict[str, tuple[str, ConstraintSettings | None]] = {
    **{name: (name, None) for name in VARIANT_NAMES},
    "constraint, stiff": ("constraint", STIFF),
}


@dataclass(frozen=True)
class Entry:
    """One row: RMSE per axis at each step of `STEPS` (S, n), cost of a step [s], longest stable step [s]."""

    position: np.ndarray
    torque: np.ndarray
    cost: float
    longest: float


def main() -> None:
    """Run, print, draw, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=Path("out/variants"))
    parser.add_argument("--seconds", type=float, default=SECONDS, help="length of the chirp")
    arguments = parser.parse_args()
    model, folder = load_model("leg"), arguments.output
    reference = chirp(arguments.seconds)
    truth = closed_chain(model, joint_loop(model, reference), len(reference))
    cost = costs(model)
    entries = {name: entry(model, name, reference, truth, cost[name]) for name in ROWS}
    report.print_table(result_table(entries))
    report.save_figure(result_figure(entries), folder / "variants.png", force=True)
    write_whole(folder / "variants.csv", result_csv(entries), force=True)
    print(f"Wrote {folder}.")


def chirp(seconds: float, period: float = PERIOD) -> np.ndarray:
    """Joint reference (N, 2) [rad]: 0.5 to 6 Hz, hip and knee in opposite phase, faded in."""
    t = np.arange(round(seconds / period)) * period
    phase = 2 * np.pi * (0.5 * t + (6.0 - 0.5) / (2 * seconds) * t**2)
    swing = 0.2 * np.sin(phase) * np.clip(t / 0.3, 0, 1)
    return HOLD + np.stack([swing, -1.5 * swing], axis=1)


def joint_loop(model: Model, reference: np.ndarray) -> Law:
    """The model's own joint PD, giving torque on the drives."""
    kp, kd = np.array(model.controller.kp), np.array(model.controller.kd)
    back = np.linalg.inv(model.transmission).T

    def law(row: int, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return back @ (kp * (reference[row] - q) - kd * v)

    return law


def closed_chain(model: Model, law: Law, rows: int, substeps: int = 6) -> VariantRun:
    """The mechanism itself under the same loop, by Runge-Kutta 4 at half a millisecond."""
    links, j = leg_structure(), model.transmission
    rotors, damping = np.diag(model.actuators.inertia), np.array(model.actuators.damping)

    def rate(state: np.ndarray, torque: np.ndarray) -> np.ndarray:
        at = links.reduced_dynamics(state[:2], state[2:])
        force = at.gravity - at.bias - damping * state[2:] + torque
        return np.concatenate([state[2:], np.linalg.solve(at.mass + rotors, force)])

    state, h = np.concatenate([j @ HOLD, np.zeros(2)]), PERIOD / substeps
    q, v, tau = (np.empty((rows, 2)) for _ in range(3))
    for row in range(rows):
        q[row], v[row] = np.linalg.solve(j, state[:2]), np.linalg.solve(j, state[2:])
        tau[row] = law(row, q[row], v[row])
        for _ in range(substeps):
            a = rate(state, tau[row])
            b = rate(state + h / 2 * a, tau[row])
            c = rate(state + h / 2 * b, tau[row])
            d = rate(state + h * c, tau[row])
            state = state + h / 6 * (a + 2 * b + 2 * c + d)
    return VariantRun(np.arange(rows) * PERIOD, q, v, tau)


def entry(model: Model, name: str, reference: np.ndarray, truth: VariantRun, cost: float) -> Entry:
    """Run one row of the table at every step."""
    variant, settings = ROWS[name]
    law, position, torque = joint_loop(model, reference), [], []
    for step in STEPS:
        run = run_variant(
            model, variant, law, rows=len(reference), period=PERIOD, step=step,
            start=(HOLD, np.zeros(2)), constraint=settings, strict=False,
        )  # fmt: skip
        position.append(rms(run.position - truth.position))
        torque.append(rms(run.torque - truth.torque))
    return Entry(np.array(position), np.array(torque), cost, longest_step(model, name))


def longest_step(model: Model, name: str) -> float:
    """Longest of `LONGEST` at which the loop, sampled at each step, stays within a radian; 0 if none."""
    variant, settings = ROWS[name]
    longest = 0.0
    for step in LONGEST:
        reference = chirp(3.0, step)
        try:
            run = run_variant(
                model, variant, joint_loop(model, reference), rows=len(reference), period=step, step=step,
                start=(HOLD, np.zeros(2)), constraint=settings, strict=False,
            )  # fmt: skip
        except SimulationError:
            break
        if not (np.abs(run.position - reference) < 1.0).all():
            break
        longest = step
    return longest


def rms(error: np.ndarray) -> np.ndarray:
    """Root mean square over rows, per axis (n,)."""
    return np.sqrt(np.mean(error**2, axis=0))


def costs(model: Model, rounds: int = 400, steps: int = 200) -> dict[str, float]:
    """Time of one step [s]; plain MuJoCo models alternate, and the median of their rounds counts."""
    plain = {name: normalise(model, name).mujoco for name in VARIANTS}
    for name, (variant, settings) in ROWS.items():
        if variant == "constraint":
            spec = loop_spec(model, settings or ConstraintSettings())
            spec.option.timestep, spec.option.integrator = 0.001, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
            plain[name] = spec.compile()
    data = {name: mujoco.MjData(m) for name, m in plain.items()}
    times: dict[str, list[float]] = {name: [] for name in plain}
    for _ in range(rounds):
        for name, m in plain.items():
            mujoco.mj_resetData(m, data[name])
            mujoco.mj_step(m, data[name], 10)
            begun = time.perf_counter()
            mujoco.mj_step(m, data[name], steps)
            times[name].append((time.perf_counter() - begun) / steps)
    out = {name: float(np.median(values)) for name, values in times.items()}
    ratio = {name: np.median(np.array(v) / np.array(times["kin_only"])) for name, v in times.items()}
    out = {name: float(ratio[name] * out["kin_only"]) for name in out}
    return out | {name: _cost_per_step(model, name) for name in ROWS if name not in out}


def _cost_per_step(model: Model, variant: str) -> float:
    """Wall time of one step of 1 ms, what Python does at it included [s]; the least of five rounds."""
    world, times, steps = make_world(model, variant, 0.001), [], 3000
    for _ in range(5):
        begun = time.perf_counter()
        world.advance(np.zeros(model.size), steps)
        times.append((time.perf_counter() - begun) / steps)
    return min(times)


def result_table(entries: dict[str, Entry]) -> Table:
    """Errors at a step of 1 ms, cost, and the longest step."""
    heads = ("mrad", "N m", "µs a step", "ratio", "longest ms")
    table = new_table("variant", *((head, "right") for head in heads))
    table.title = "Against the closed chain, hip and knee: RMSE at steps of 1 ms"
    at, base = STEPS.index(0.001), entries["kin_only"].cost
    for name, e in entries.items():
        position = ", ".join(f"{1e3 * x:.2f}" for x in e.position[at])
        torque = ", ".join(f"{x:.3f}" for x in e.torque[at])
        in_python = name in PER_STEP and not name.startswith("constraint")
        table.add_row(
            f"{name} *" if in_python else name,
            position, torque, f"{1e6 * e.cost:.2f}", f"{e.cost / base:.2f}", f"{1e3 * e.longest:g}",
        )  # fmt: skip
    table.caption = "* torques at every step come from Python; the others are stepped in C"
    return table


def result_csv(entries: dict[str, Entry]) -> str:
    """All numbers, one row a variant and step."""
    lines = [
        "variant,step_s,position_hip_rad,position_knee_rad,torque_hip_Nm,torque_knee_Nm,cost_s,longest_s"
    ]
    for name, e in entries.items():
        for k, step in enumerate(STEPS):
            numbers = [step, *e.position[k], *e.torque[k], e.cost, e.longest]
            lines.append(",".join([name.replace(",", ""), *(f"{x:.6g}" for x in numbers)]))
    return "\n".join(lines) + "\n"


def result_figure(entries: dict[str, Entry]) -> Figure:
    """Position error over the step, and torque error over the cost of a step."""
    figure = Figure(figsize=(8.4, 3.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    colors = ("#D55E00", "#009E73", "#0072B2", "#1a1c1e", "#56B4E9", "#E69F00", "#CC79A7", "#8a9096")
    for (name, e), color, marker in zip(entries.items(), colors, "osD^vPX*", strict=True):
        whole = 1e3 * np.sqrt(np.mean(e.position**2, axis=1))
        left.plot(1e3 * np.array(STEPS), whole, color=color, marker=marker, ms=4, lw=1, label=name)
        torque = float(np.sqrt(np.mean(e.torque[STEPS.index(0.001)] ** 2)))
        right.plot(1e6 * e.cost, torque, color=color, marker=marker, ms=6, ls="", label=name)
    for ax in (left, right):
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.grid(alpha=0.25)
        ax.spines[["top", "right"]].set_visible(False)
    costs_shown = (2, 3, 5, 10, 20)
    for ax, ticks in ((left, [1e3 * s for s in STEPS]), (right, costs_shown)):
        ax.set_xticks(ticks, [f"{t:g}" for t in ticks])
        ax.xaxis.set_minor_locator(NullLocator())
    left.set_xlabel("step [ms]")
    left.set_title("position RMSE [mrad]", fontsize=9, loc="left")
    right.set_xlabel("cost of a step [µs]")
    right.set_title("torque RMSE [N m] at 1 ms", fontsize=9, loc="left")
    figure.legend(
        *left.get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False, fontsize=8
    )
    return figure


if __name__ == "__main__":
    main()
