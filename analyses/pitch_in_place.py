"""Pitch in place (paper, Sec. VI-B): the body moves alike in simulation and hardware; do forces?

    python analyses/pitch_in_place.py --out out/pitch

Each policy pitches the trunk by 0.1 rad at 5 Hz on the virtual quadruped and in its simulator. After a
second, 40 cycles count: pitch rates are averaged by phase and their RMSE is divided by the hardware's peak
to peak; forces are those of the rear right foot, the mean over 3 ms, and their RMSE is over all rows.
A trial is a policy from another training seed, with its own noise.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from transfer_looks import LOOKS
from transfer_plants import SETS
from transfer_policies import TRAINED, Job, Rollout, Simulators, build_all, methods_of, rollout
from transfer_tables import show, spread, write_csv
from transfer_trials import run_trials

from workbench import report
from workbench.core.palette import COLOURS
from workbench.models import Model
from workbench.training.machine import STEP_S
from workbench.training.tasks import PITCH_HZ

PAPER = {
    "Kin-Only": ("3.95", "27.1"),
    "Kin-Only HR": ("4.92", ""),
    "S3N-Act": ("1.62", "9.5"),
    "S3N-Full": ("2.64", "10.2"),
}
_SETTLE, _CYCLES, _PHASES = 5, 40, 100  # cycles, cycles, points a cycle


@dataclass(frozen=True)
class Result:
    """One method on one set: RMSE of a trial each (T,), curves over phase (100,) of the first."""

    pitch_percent: np.ndarray
    force: np.ndarray
    range_rad_s: np.ndarray
    hardware: tuple[np.ndarray, np.ndarray]
    simulation: tuple[np.ndarray, np.ndarray]
    gap: np.ndarray


def main(arguments: Sequence[str] | None = None) -> dict[str, dict[str, Result]]:
    """Run, print, write, draw; returns the results by set and method."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("out/pitch"))
    parser.add_argument("--seed", type=int, default=0)
    most = TRAINED["pitch-in-place"]
    parser.add_argument(
        "--trials", type=int, default=most, choices=range(1, most + 1), help="training seeds, and noise"
    )
    parser.add_argument("--models", type=Path, help="models that chirp_response.py identified; else anew")
    parser.add_argument("--set", choices=list(SETS), help="one of the sets; else all")
    parser.add_argument("--quick", action="store_true", help="two methods, four cycles, clean, nothing found")
    given = parser.parse_args(arguments)
    sets = ["clean"] if given.quick else [given.set] if given.set else list(SETS)
    methods = ["Kin-Only", "S3N-Full"] if given.quick else None
    cycles, trials = (4, 1) if given.quick else (_CYCLES, given.trials)
    built = build_all(sets, given.seed, given.models, given.quick)
    results = {
        which: evaluate_set(which, built[which], methods, cycles, given.seed, trials, given.quick)
        for which in sets
    }
    for which, mine in results.items():
        table(given.out, which, mine, built[which])
    rows = [
        {
            "set": which, "method": name, "trial": k, "pitch_rate_percent": float(r.pitch_percent[k]),
            "force_rmse_N": float(r.force[k]), "peak_to_peak_rad_s": float(r.range_rad_s[k]),
        }
        for which, mine in results.items() for name, r in mine.items() for k in range(trials)
    ]  # fmt: skip
    write_csv(given.out / "pitch.csv", rows)
    report.save_figure(figure(results), given.out / "pitch.png", force=True)
    print(f"Wrote {given.out}.")
    return results


def evaluate_set(
    which: str, built: Simulators, methods: Sequence[str] | None, cycles: int, seed: int, trials: int,
    quick: bool,
) -> dict[str, Result]:  # fmt: skip
    """These methods (all) on hardware that hides one set; a policy that two methods share runs there once."""
    seconds = (_SETTLE + cycles + 0.5) / PITCH_HZ
    known = methods_of("pitch-in-place", which)
    methods = methods or list(known)
    policies = list(dict.fromkeys(known[m][0] for m in methods))

    def job(policy: str, k: int, model: Model | None = None) -> Job:
        return Job("pitch-in-place", policy, seconds, seed + k, which, model=model, trained=k)

    jobs = [job(p, k) for p in policies for k in range(trials)]
    jobs += [job(known[m][0], k, built.models[known[m][1]]) for m in methods for k in range(trials)]
    made = run_trials(rollout, jobs, serial=quick)
    each = [made[i : i + trials] for i in range(0, len(made), trials)]
    hardware, simulated = dict(zip(policies, each, strict=False)), each[len(policies) :]
    return {m: result(hardware[known[m][0]], s, cycles) for m, s in zip(methods, simulated, strict=True)}


def result(hardware: Sequence[Rollout], simulated: Sequence[Rollout], cycles: int) -> Result:
    """Both errors of each trial; NaN where the robot fell."""
    first, last = (round(c / PITCH_HZ / STEP_S) for c in (_SETTLE, _SETTLE + cycles))
    rows = []
    for run, simulation in zip(hardware, simulated, strict=True):
        if run.fell_s is not None:
            rows.append((np.nan, np.nan, np.nan))
            continue
        rate = by_phase(run.pitch_rate, cycles).mean(axis=0)
        gap = rate - by_phase(simulation.pitch_rate, cycles).mean(axis=0)
        force = rms((run.force - simulation.force)[first:last])
        rows.append((100.0 * rms(gap) / np.ptp(rate), force, np.ptp(rate)))
    percent, force, ranges = np.array(rows).T
    own, other = ([by_phase(x, cycles) for x in (r.pitch_rate, r.force)] for r in (hardware[0], simulated[0]))
    return Result(
        percent, force, ranges,
        (own[0].mean(axis=0), own[1].mean(axis=0)), (other[0].mean(axis=0), other[1].mean(axis=0)),
        np.abs(own[1] - other[1]).mean(axis=0),
    )  # fmt: skip


def by_phase(signal: np.ndarray, cycles: int) -> np.ndarray:
    """A signal (N,) at 3 ms, cycle by cycle of the command, (cycles, 100)."""
    phase = _SETTLE + np.arange(cycles)[:, None] + np.arange(_PHASES) / _PHASES
    return np.interp(phase / PITCH_HZ, STEP_S * np.arange(len(signal)), signal)


def rms(x: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(x))))


def table(folder: Path, which: str, results: dict[str, Result], built: Simulators) -> str:
    """Errors by method beside the paper's."""
    base = results["Kin-Only"].force  # policies of one seed have nothing in common: means are compared
    rows = []
    for name, r in results.items():
        less = "" if name == "Kin-Only" else f"{100.0 * (1.0 - np.nanmean(r.force) / np.nanmean(base)):.1f}"
        paper = PAPER.get(name, ("", ""))
        rows.append((
            name, spread(r.pitch_percent, 2), paper[0], spread(r.force, 2), paper[1], less,
            spread(r.range_rad_s, 2),
        ))  # fmt: skip
    columns = (
        "method", "pitch rate [% of range]", "paper", "force RMSE [N]", "paper", "force less by [%]",
        "range [rad/s]",
    )  # fmt: skip
    title = f"Pitch in place, {which}: {len(base)} training seeds, mean ± sample standard deviation"
    text = show(folder, which.replace(" ", "_"), title, columns, rows)
    print(built.about)
    return text


def figure(results: dict[str, dict[str, Result]]) -> Figure:
    """Pitch rate over a cycle, and the gap of the force over a cycle, set by set."""
    with report.house_style():
        made = Figure(figsize=(9.0, 0.6 + 2.6 * len(results)), layout="constrained")
        axes = made.subplots(len(results), 3, squeeze=False)
        phase = np.linspace(0.0, 360.0, _PHASES, endpoint=False)
        for row, (which, mine) in zip(axes, results.items(), strict=True):
            measured = np.array([r.hardware[0] for r in mine.values()])
            mean, spread_ = measured.mean(axis=0), measured.std(axis=0)
            row[0].fill_between(phase, mean - spread_, mean + spread_, color=COLOURS["measured"][0], lw=0)
            row[0].plot(phase, mean, color=COLOURS["quiet"][0], lw=1.6, label="hardware, mean of the methods")
            for name, r in mine.items():
                look = LOOKS[name].drawn()
                row[0].plot(phase, r.simulation[0], **look, label=name)
                row[1].plot(phase, r.gap, **look)
                x = list(mine).index(name)
                row[2].errorbar(
                    np.nanmean(r.force), x, xerr=np.nanstd(r.force), fmt="o", color=look["color"], ms=5
                )
            row[0].set_title(f"{which}: pitch rate [rad/s]")
            row[1].set_title("|gap| of the foot's force [N]")
            row[2].set_title("RMSE of force [N]")
            row[2].set_yticks(range(len(mine)), list(mine))
            row[2].invert_yaxis()
            row[2].set_xlim(left=0.0)
        for a in axes[:, :2].ravel():
            a.set_xticks([0, 90, 180, 270, 360])
        for a in axes[-1, :2]:
            a.set_xlabel("phase of the command [°]")
        entries = {
            label: h for a in axes[:, 0] for h, label in zip(*a.get_legend_handles_labels(), strict=True)
        }
        made.legend(entries.values(), entries.keys(), loc="outside upper left", ncols=4)
    return made


if __name__ == "__main__":
    main()
