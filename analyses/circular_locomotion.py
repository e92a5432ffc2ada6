"""Circular locomotion (paper, Sec. VI-C): how far are velocities in hardware from those in simulation?

    python analyses/circular_locomotion.py --out out/circular

Each policy runs one lap, at 0.8 m/s and 0.8 rad/s from standing, on the virtual quadruped and in its
simulator. A trial has its own noise and its own friction of the ground, 0.6 to 1.0, and policies of several
training seeds run all of them. Rows are paired in time from the command's onset; E_phi averages the gap,
divided by the command, over 72 bins of the lap's phase (Eqs. 31, 32), E_RMSE is from RMSE over the lap
(Eq. 30).
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from transfer_looks import LOOKS
from transfer_plants import SETS
from transfer_policies import TRAINED, Job, Rollout, Simulators, build_all, methods_of, rollout
from transfer_tables import show, spread, write_csv
from transfer_trials import run_trials

from workbench import report
from workbench.training.machine import STEP_S
from workbench.training.tasks import CIRCLE

PAPER = {
    "Kin-Only": ("0.167", "0.144", "19.46", "17.3"),
    "Kin-Only HR": ("0.220", "0.167", "24.17", "21.5"),
    "S3N-Act": ("0.164", "0.128", "18.26", "15.7"),
    "S3N-Full": ("0.074", "0.122", "12.23", "9.9"),
}
_LAP_S = 2 * np.pi / CIRCLE[2]
_BINS = 72
_FRICTION = (0.6, 1.0)


@dataclass(frozen=True)
class Gap:
    """One method on one set, policies of S training seeds in T trials each; NaN where the robot fell.

    Attributes:
        forward, yaw: RMSE over the lap (S, T) [m/s, rad/s].
        whole: E_RMSE (S, T) [%].
        local: gap by phase (S, T, 72) [%]; its mean is E_phi.
        again: E_phi of the hardware against its own first trial (S, T - 1) [%]: what noise and ground leave.
    """

    forward: np.ndarray
    yaw: np.ndarray
    whole: np.ndarray
    local: np.ndarray
    again: np.ndarray

    @property
    def phase(self) -> np.ndarray:
        """E_phi of each trial (S, T) [%]."""
        return self.local.mean(axis=-1)


def main(arguments: Sequence[str] | None = None) -> dict[str, dict[str, Gap]]:
    """Run, print, write, draw; returns the gaps by set and method."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("out/circular"))
    parser.add_argument("--seed", type=int, default=0)
    most = TRAINED["circular"]
    parser.add_argument("--trials", type=int, default=5, help="of each policy")
    parser.add_argument(
        "--trained", type=int, default=most, choices=range(1, most + 1), help="training seeds"
    )
    parser.add_argument("--models", type=Path, help="models that chirp_response.py identified; else anew")
    parser.add_argument("--set", choices=list(SETS), help="one of the sets; else all")
    parser.add_argument("--quick", action="store_true", help="two methods, a quarter of a lap, nothing found")
    given = parser.parse_args(arguments)
    sets = ["clean"] if given.quick else [given.set] if given.set else list(SETS)
    methods = ["Kin-Only", "S3N-Full"] if given.quick else None
    shape, seconds = ((1, 1), 0.25 * _LAP_S) if given.quick else ((given.trained, given.trials), _LAP_S)
    built = build_all(sets, given.seed, given.models, given.quick)
    results = {
        which: evaluate_set(which, built[which], methods, seconds, given.seed, shape, given.quick)
        for which in sets
    }
    for which, mine in results.items():
        table(given.out, which, mine, built[which])
    rows = [
        {
            "set": which, "method": name, "training_seed": k[0], "trial": k[1],
            "e_vx_m_s": float(g.forward[k]), "e_wz_rad_s": float(g.yaw[k]),
            "E_RMSE_percent": float(g.whole[k]), "E_phi_percent": float(g.phase[k]),
        }
        for which, mine in results.items() for name, g in mine.items() for k in np.ndindex(shape)
    ]  # fmt: skip
    write_csv(given.out / "circular.csv", rows)
    for which, mine in results.items():
        report.save_figure(polar(which, mine), given.out / f"{which.replace(' ', '_')}.png", force=True)
    print(f"Wrote {given.out}.")
    return results


def evaluate_set(
    which: str, built: Simulators, methods: Sequence[str] | None, seconds: float, seed: int,
    shape: tuple[int, int], quick: bool,
) -> dict[str, Gap]:  # fmt: skip
    """These methods (all) on hardware that hides one set, `shape` = (training seeds, trials).

    A policy that two methods share runs there once.
    """
    trained, trials = shape
    known = methods_of("circular", which)
    methods = methods or list(known)
    policies = list(dict.fromkeys(known[m][0] for m in methods))
    ground = np.random.default_rng([seed, 5]).uniform(*_FRICTION, trials)

    def on_hardware(policy: str, s: int, k: int) -> Job:
        friction = float(ground[k])
        return Job("circular", policy, seconds, seed + k, which, friction=friction, trained=s)

    def simulated(method: str, s: int) -> Job:
        policy, model = known[method]
        return Job("circular", policy, seconds, seed, model=built.models[model], trained=s)

    jobs = [on_hardware(p, s, k) for p in policies for s in range(trained) for k in range(trials)]
    jobs += [simulated(m, s) for m in methods for s in range(trained)]
    made = iter(run_trials(rollout, jobs, serial=quick))
    hardware = {p: [[next(made) for _ in range(trials)] for _ in range(trained)] for p in policies}
    return {m: gap(hardware[known[m][0]], [next(made) for _ in range(trained)]) for m in methods}


def gap(hardware: Sequence[Sequence[Rollout]], simulation: Sequence[Rollout]) -> Gap:
    """The paper's metrics: policies of S training seeds in T trials each, and their S simulations."""
    rows = max(len(run.yaw) for runs in (*hardware, simulation) for run in runs)
    pairs = [[apart(run, own, rows) for run in runs] for runs, own in zip(hardware, simulation, strict=True)]
    forward, yaw = (
        np.array([[np.sqrt(np.mean(pair[i] ** 2)) for pair in runs] for runs in pairs]) for i in (0, 1)
    )
    local = np.array([[by_phase(*pair) for pair in runs] for runs in pairs])
    again = [[by_phase(*apart(run, runs[0], rows)).mean() for run in runs[1:]] for runs in hardware]
    whole = 50.0 * (forward / abs(CIRCLE[0]) + yaw / abs(CIRCLE[2]))
    return Gap(forward, yaw, whole, local, np.array(again))


def apart(one: Rollout, other: Rollout, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """How far forward velocity and yaw rate are apart, (rows,) each; NaN where one of them fell."""
    if one.fell_s is not None or other.fell_s is not None:
        nothing = np.full(rows, np.nan)
        return nothing, nothing
    return np.abs(one.forward - other.forward), np.abs(one.yaw - other.yaw)


def by_phase(ahead: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """The gap by phase of the lap (72,) [%], fewer of a part of one (Eq. 31)."""
    bins = np.minimum((STEP_S * np.arange(len(turn)) / _LAP_S * _BINS).astype(int), _BINS - 1)
    both = 50.0 * (ahead / abs(CIRCLE[0]) + turn / abs(CIRCLE[2]))
    return np.bincount(bins, both) / np.bincount(bins)


def table(folder: Path, which: str, results: dict[str, Gap], built: Simulators) -> str:
    """The four metrics by method, each beside the paper's."""
    rows = []
    for name, g in results.items():
        paper = PAPER.get(name, ("",) * 4)
        mine = (
            of_seeds(g.forward, 3), of_seeds(g.yaw, 3), of_seeds(g.whole, 2), of_seeds(g.phase, 2),
        )  # fmt: skip
        cells = [cell for pair in zip(mine, paper, strict=True) for cell in pair]
        fell = int(np.sum(~np.isfinite(g.whole)))
        rows.append((name, *cells, within(g.phase), of_seeds(g.again, 2), str(fell)))
    columns = (
        "method", "e_vx [m/s]", "paper", "e_wz [rad/s]", "paper", "E_RMSE [%]", "paper", "E_phi [%]", "paper",
        "E_phi from trial to trial ± [%]", "hardware again [%]", "fell",
    )  # fmt: skip
    trained, trials = next(iter(results.values())).forward.shape
    title = (
        f"Circular locomotion, {which}: mean ± sample standard deviation over {trained} training seeds, "
        f"{trials} trials of each"
    )
    text = show(folder, which.replace(" ", "_"), title, columns, rows)
    print(built.about)
    return text


def of_seeds(values: np.ndarray, digits: int) -> str:
    """Mean over trials of each training seed (S, T), and how the seeds scatter."""
    return spread([x[np.isfinite(x)].mean() for x in values if np.isfinite(x).any()], digits)


def within(values: np.ndarray) -> str:
    """Sample standard deviation of trials (S, T) about their own training seed's mean."""
    upright = [x[np.isfinite(x)] for x in values]
    variances = [x.var(ddof=1) for x in upright if len(x) > 1]
    return f"{np.sqrt(np.mean(variances)):.2f}" if variances else "–"


def polar(which: str, results: dict[str, Gap]) -> Figure:
    """The gap over the phase of the lap, a panel a method; thin lines are laps."""
    with report.house_style():
        figure = Figure(figsize=(2.3 * len(results), 2.75), layout="constrained")
        axes = np.atleast_1d(
            figure.subplots(1, len(results), subplot_kw={"projection": "polar"}, squeeze=False)[0]
        )
        most = max(np.nanmax(g.local) for g in results.values())
        for a, (name, g) in zip(axes, results.items(), strict=True):
            laps = g.local.reshape(-1, g.local.shape[-1])
            angle = (np.arange(laps.shape[1]) + 0.5) * 2 * np.pi / _BINS
            whole = laps.shape[1] == _BINS  # close the circle of a whole lap

            def closed(x: np.ndarray, whole: bool = whole) -> np.ndarray:
                return np.append(x, x[0]) if whole else x

            for trial in laps:
                a.plot(closed(angle), closed(trial), color=LOOKS[name].light, lw=0.6, alpha=0.35)
            a.plot(closed(angle), closed(np.nanmean(laps, axis=0)), color=LOOKS[name].light, lw=1.8)
            a.set_ylim(0.0, 1.05 * most)
            a.set_theta_zero_location("N")
            a.set_xticks(np.radians([0, 90, 180, 270]))
            a.tick_params(labelsize=7, pad=-1)
            a.set_rlabel_position(135)
            a.yaxis.set_major_locator(MaxNLocator(3))
            a.set_title(f"{name}\n$E_\\phi$ = {of_seeds(g.phase, 1)} %", loc="center")
        figure.suptitle(
            f"Gap between simulation and hardware over the lap, % of the command; {which}", fontsize=9.5
        )
    return figure


if __name__ == "__main__":
    main()
