"""A transmission that depends on the posture, in MuJoCo without its loops: error, cost and longest step.

    python analyses/mechanisms.py -o out/mechanisms

Ways: the serial tree with J by virtual work only (kin_only), rotors behind a J that is frozen at the middle
(s3n_frozen), the fitted plain MJCF, fields written at every step (scheduled) or every fourth, inertia added
in MuJoCo's callback, and the loop closed by equality constraints. A chirp in joint coordinates is tracked by
a joint loop, once by the closed chain in Drake and once by each way. Times alternate, so that a busy machine
disturbs all alike, and count as ratios to kin_only.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator
from mechanism_costs import WORLDS, batch_costs, costs
from mechanism_ways import PERIOD, WAYS, Bench
from rich.table import Table

from workbench import load_model, report
from workbench.core import SimulationError
from workbench.core.files import write_whole
from workbench.mechanism import ClosedChain
from workbench.report.layout import table as new_table
from workbench.s3n import compiled_dynamics
from workbench.s3n.posture_error import relative_inertia, workspace_grid
from workbench.s3n.worlds import World

NAMES = ("four_bar", "five_bar", "ankle")
STEPS = (0.00025, 0.0005, 0.001, 0.002, 0.004)  # of the motion [s], whole parts of the period
LONGEST = (0.002, 0.003, 0.004, 0.006, 0.008, 0.010, 0.012, 0.015, 0.020, 0.030)  # control period = step [s]
_COLORS = ("#D55E00", "#E69F00", "#009E73", "#0072B2", "#CC79A7", "#56B4E9", "#1a1c1e")


@dataclass(frozen=True)
class Entry:
    """One way: relative error of the inertia (largest, rms; NaN without one), RMSE at each step of `STEPS`.

    `position` [rad] and `torque` [N m], (S,); `cost`, `batch`: time of a step over that of kin_only, of one
    world and of a world among `WORLDS`; `longest`: longest stable step [s].
    """

    inertia: tuple[float, float]
    position: np.ndarray
    torque: np.ndarray
    cost: float
    batch: float
    longest: float


def main() -> None:
    """Run, print, draw, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=Path("out/mechanisms"))
    parser.add_argument("--models", nargs="+", default=list(NAMES))
    arguments = parser.parse_args()
    results: dict[str, dict[str, Entry]] = {}
    for name in arguments.models:
        results[name] = measure(Bench(load_model(name)))
        report.print_table(result_table(name, results[name]))
    report.save_figure(result_figure(results), arguments.output / "mechanisms.png", force=True)
    write_whole(arguments.output / "mechanisms.csv", result_csv(results), force=True)
    print(f"Wrote {arguments.output}.")


def measure(bench: Bench) -> dict[str, Entry]:
    """Every way of one mechanism."""
    reference = bench.chirp(PERIOD)
    truth = closed_chain(bench, reference)
    cost, batch, out = costs(bench), batch_costs(bench), {}
    for way in WAYS:
        runs = [track(bench, bench.world(way, step), reference, PERIOD) for step in STEPS]
        position, torque = (
            np.array([np.sqrt(np.mean((run[k] - truth[k]) ** 2)) for run in runs]) for k in (0, 1)
        )
        longest = longest_step(bench, way)
        out[way] = Entry(inertia_error(bench, way), position, torque, cost[way], batch[way], longest)
    return out


def inertia_error(bench: Bench, way: str) -> tuple[float, float]:
    """Largest and rms relative error of the inertia over the workspace."""
    q = workspace_grid(bench.chain.box)
    real = bench.chain.mass(q)
    if way in ("scheduled", "scheduled_4", "callback"):
        world, mass = bench.world("scheduled", 0.001), np.empty_like(real)
        for k, row in enumerate(q):
            world.put(row, np.zeros_like(row))
            world.advance(np.zeros_like(row), 1)  # writes the fields of the posture before it steps
            mujoco.mj_fullM(world.m, world.data, mass[k])
    elif way == "constraint":
        return float("nan"), float("nan")
    else:
        mass = compiled_dynamics(bench.plain(way), bench.model.joints, q, np.zeros_like(q)).mass
    off = relative_inertia(mass, real)
    return float(np.abs(off).max()), float(np.sqrt(np.mean(off**2)))


def track(bench: Bench, world: World, reference: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Positions and torques (N, n) of a world in the joint loop; NaN from where it is lost."""
    law, steps = bench.law(reference), round(period / world.m.opt.timestep)
    q, tau = np.full_like(reference, np.nan), np.full_like(reference, np.nan)
    for row in range(len(reference)):
        position, velocity = world.state()
        if not (np.abs(position - reference[row]) < 1.0).all():
            break
        q[row], tau[row] = position, law(row, position, velocity)
        world.advance(tau[row], steps)
    return q, tau


def closed_chain(bench: Bench, reference: np.ndarray, substeps: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Positions and torques of the mechanism itself in the same loop: Drake, by Runge-Kutta 4."""
    assert bench.model.closed_chain is not None
    chain, law, h = ClosedChain(bench.model.closed_chain), bench.law(reference), PERIOD / substeps
    inertia, damping = (np.array(x) for x in (bench.model.actuators.inertia, bench.model.actuators.damping))
    n = bench.model.size

    def rate(state: np.ndarray, torque: np.ndarray) -> np.ndarray:
        q, v = state[:n], state[n:]
        at, j = chain.serial_dynamics(q, v), chain.jacobian(q)
        drives = torque - inertia * chain.jacobian_bias(q, v) - damping * (j @ v)
        force = at.gravity - at.bias + j.T @ drives
        return np.concatenate([v, np.linalg.solve(at.mass + j.T @ (inertia[:, None] * j), force)])

    state, q, tau = np.concatenate([bench.middle, np.zeros(n)]), [], []
    for row in range(len(reference)):
        q.append(state[:n])
        tau.append(law(row, state[:n], state[n:]))
        for _ in range(substeps):
            a = rate(state, tau[-1])
            b = rate(state + h / 2 * a, tau[-1])
            c = rate(state + h / 2 * b, tau[-1])
            d = rate(state + h * c, tau[-1])
            state = state + h / 6 * (a + 2 * b + 2 * c + d)
    return np.array(q), np.array(tau)


def longest_step(bench: Bench, way: str) -> float:
    """Longest of `LONGEST` at which the loop, sampled at each step, stays within a radian; 0 if none."""
    longest = 0.0
    for step in LONGEST:
        try:
            q, _ = track(bench, bench.world(way, step), bench.chirp(step), step)
        except SimulationError:
            break
        if np.isnan(q).any():
            break
        longest = step
    return longest


def result_table(name: str, entries: dict[str, Entry]) -> Table:
    """Errors at a step of 1 ms, costs and the longest step."""
    heads = ("max %", "rms %", "mrad", "N m", "cost", f"{WORLDS}", "ms")
    table = new_table("way", *((head, "right") for head in heads))
    table.title = f"{name} against the closed chain"
    table.caption = (
        "Error of the inertia over the workspace; RMSE of position and torque at steps of 1 ms; cost of a "
        f"step over kin_only's, of one world and among {WORLDS}; longest stable step."
    )
    at = STEPS.index(0.001)
    for way, e in entries.items():
        shares = ["0" if x < 1e-6 else f"{100 * x:.2f}" for x in e.inertia]
        cells = [*shares, f"{1e3 * e.position[at]:.2f}", f"{e.torque[at]:.3f}"]
        cells += [f"{e.cost:.2f}", f"{e.batch:.2f}", f"{1e3 * e.longest:g}"]
        table.add_row(way, *("" if cell == "nan" else cell for cell in cells))
    return table


def result_csv(results: dict[str, dict[str, Entry]]) -> str:
    """All numbers, one row a mechanism, way and step."""
    lines = ["model,way,step_s,position_rad,torque_Nm,inertia_max,inertia_rms,cost,cost_batch,longest_s"]
    for name, entries in results.items():
        for way, e in entries.items():
            for k, step in enumerate(STEPS):
                numbers = (step, e.position[k], e.torque[k], *e.inertia, e.cost, e.batch, e.longest)
                lines.append(",".join([name, way, *(f"{x:.6g}" for x in numbers)]))
    return "\n".join(lines) + "\n"


def result_figure(results: dict[str, dict[str, Entry]]) -> Figure:
    """By mechanism: position error over the step, and over the cost of a step among many worlds.

    The callback has no batch: its cost is that of one world.
    """
    figure = Figure(figsize=(9.0, 5.2), layout="constrained")
    axes = figure.subplots(2, len(results), squeeze=False, sharey="row")
    at = STEPS.index(0.001)
    for column, (name, entries) in enumerate(results.items()):
        top, bottom = axes[:, column]
        top.set_xscale("log")
        bottom.set_xscale("log")
        for (way, e), color, marker in zip(entries.items(), _COLORS, "osD^*vX", strict=True):
            style = {"color": color, "marker": marker, "ms": 5, "label": way}
            top.plot(1e3 * np.array(STEPS), 1e3 * e.position, lw=1, **style)
            cost = e.cost if np.isnan(e.batch) else e.batch
            bottom.plot(cost, 1e3 * e.position[at], ls="", **style)
        top.set_title(name, fontsize=9, loc="left", weight="bold")
        top.set_xlabel("step [ms]")
        bottom.set_xlabel(f"cost over kin_only's, {WORLDS} worlds")
        bottom.set_xticks((1, 3, 10, 30, 100, 300), ("1", "3", "10", "30", "100", "300"))
        bottom.set_xlim(0.7, 400)
        bottom.xaxis.set_minor_locator(NullLocator())
        top.set_xticks([1e3 * s for s in STEPS], [f"{1e3 * s:g}" for s in STEPS])
        top.xaxis.set_minor_locator(NullLocator())
    axes[0, 0].set_ylabel("position RMSE [mrad]")
    axes[1, 0].set_ylabel("RMSE [mrad] at 1 ms")
    for ax in axes.ravel():
        ax.set_yscale("log")
        ax.grid(alpha=0.25)
        ax.spines[["top", "right"]].set_visible(False)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=7, frameon=False, fontsize=8)
    return figure


if __name__ == "__main__":
    main()
