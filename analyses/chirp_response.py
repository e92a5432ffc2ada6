"""The contact-free leg (paper, Sec. V): chirps of 0.2 rad from 0.1 to 25 Hz, measured and simulated.

    python analyses/chirp_response.py --out out/chirp

Virtual hardware is the closed chain in Drake with encoders, noise and delay, clean and with effects hidden in
it. Every simulator is built from recordings alone: drives on a bench, sum and difference modes of the leg,
Algorithm 1; S3N + found effects is what `improve` adds from other recordings than the chirps. The reference
leg is measured with several seeds of noise, and so are legs that differ from it.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter
from transfer_chirp import NAMES, Task, Trial, reduction, run_trial
from transfer_identification import AXES
from transfer_looks import LOOKS
from transfer_plants import SETS, other_leg, reference_leg
from transfer_tables import show, spread, write_csv
from transfer_trials import run_trials

from workbench import report
from workbench.core.palette import COLOURS, LINES
from workbench.identification import actuator_figure
from workbench.models import write_model

PAPER = {
    "kin_only": ("0.0271, 0.0353", "3.58, 4.86", ""),
    "s3n_full": ("0.0073, 0.0046", "0.90, 0.61", "80.9, 82.1"),
}
_CURVES = ("kin_only", "s3n_act", "s3n_full", "found")


def main(arguments: Sequence[str] | None = None) -> list[tuple[str, Trial]]:
    """Run all trials, print and write tables, draw; returns set and trial of each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("out/chirp"))
    parser.add_argument("--seed", type=int, default=0, help="first seed; the others follow")
    parser.add_argument("--trials", type=int, default=3, help="seeds of noise on the reference leg")
    parser.add_argument("--plants", type=int, default=2, help="legs that differ from it")
    parser.add_argument("--set", choices=list(SETS), help="one of the sets; else all")
    parser.add_argument("--quick", action="store_true", help="one clean trial with short recordings")
    given = parser.parse_args(arguments)
    results = run(
        [given.set] if given.set else list(SETS), given.seed, given.trials, given.plants, given.quick
    )
    folder = given.out
    for name in dict.fromkeys(which for which, _ in results):
        mine = [trial for which, trial in results if which == name]
        slug = name.replace(" ", "_")
        reference = [t for t in mine if t.plant.name == "reference leg"]
        others = [t for t in mine if t.plant.name != "reference leg"]
        for what, trials in (("reference leg", reference), ("other legs", others)):
            if trials:
                title = f"{what.capitalize()}, {name}: {len(trials)} trials, mean ± sample standard deviation"
                table(folder, f"{slug}_{what.replace(' ', '_')}", title, trials)
        identified(folder, f"{slug}_identified", name, mine)
        for variant in ("kin_only", "s3n_act", "s3n_full", "found"):
            write_model(
                reference[0].models[variant], folder / "models" / f"{slug}_{variant}.toml", force=True
            )
        report.save_figure(curves(reference[0]), folder / f"{slug}_curves.png", force=True)
        for axis, drive in zip(AXES, reference[0].known.drives, strict=True):
            report.save_figure(actuator_figure(drive), folder / f"{slug}_drive_{axis}.png", force=True)
    write_csv(folder / "chirp.csv", [row for which, t in results for row in numbers(which, t)])
    report.save_figure(summary(results), folder / "summary.png", force=True)
    print(f"Wrote {folder}.")
    return results


def run(sets: Sequence[str], seed: int, trials: int, plants: int, quick: bool) -> list[tuple[str, Trial]]:
    """Every trial of these sets, each identified and improved by itself."""
    if quick:
        return [("clean", run_trial(Task(reference_leg("clean", seed), quick=True)))]
    tasks = []
    for which in sets:
        tasks += [(which, Task(reference_leg(which, seed + k))) for k in range(trials)]
        tasks += [
            (which, Task(replace(other_leg(which, seed + k), seed=seed + 100 + k))) for k in range(plants)
        ]
    # the longest first, so that no core is left alone with one at the end
    order = sorted(range(len(tasks)), key=lambda k: tasks[k][0] == "clean")
    made = dict(zip(order, run_trials(run_trial, [tasks[k][1] for k in order]), strict=True))
    return [(tasks[k][0], made[k]) for k in range(len(tasks))]


def table(folder: Path, slug: str, title: str, trials: Sequence[Trial]) -> str:
    """RMSE by row, hip and knee each in its own chirp, and the reduction against Kin-Only."""
    rows = []
    for name, text in NAMES.items():
        have = [t for t in trials if name in t.position]
        if not have:
            continue
        hip, knee = np.array([t.position[name] for t in have]).T
        hip_torque, knee_torque = np.array([t.torque[name] for t in have]).T
        less = [""] * 2 if name == "kin_only" else [
            spread([reduction(e, name) for e in each], 1)
            for each in ([t.position for t in have], [t.torque for t in have])
        ]  # fmt: skip
        paper = PAPER.get(name, ("", "", ""))
        rows.append((
            text, spread(hip, 2, 1e3), spread(knee, 2, 1e3), spread(hip_torque, 3), spread(knee_torque, 3),
            *less, " / ".join(x for x in paper if x),
        ))  # fmt: skip
    columns = (
        "model", "hip [mrad]", "knee [mrad]", "hip [N m]", "knee [N m]", "position less by [%]",
        "torque less by [%]", "paper: rad / N m / %",
    )  # fmt: skip
    return show(folder, slug, title, columns, rows)


def identified(folder: Path, slug: str, name: str, trials: Sequence[Trial]) -> str:
    """What identification gave of every leg, and what was found in addition."""
    rows = []
    for t in trials:
        (one, two), leg = t.known.drives, t.known.leg
        rows.append((
            f"{t.plant.name}, seed {t.plant.seed}",
            *(f"{1e3 * d.inertia.value:.2f}" for d in (one, two)),
            *(f"{d.damping.value:.4f}" for d in (one, two)),
            f"{1e3 * one.delay.value:.3f}", *(f"{1e3 * x:.2f}" for x in leg.total),
            ", ".join(t.found) or "nothing",
        ))  # fmt: skip
    columns = (
        "leg", "J1 [g m²]", "J2 [g m²]", "B1 [N m s/rad]", "B2 [N m s/rad]", "delay [ms]",
        "M11 [g m²]", "M12 [g m²]", "M22 [g m²]", "found",
    )  # fmt: skip
    return show(folder, slug, f"Identified, {name}", columns, rows)


def numbers(which: str, trial: Trial) -> list[dict[str, object]]:
    """Rows of the CSV file."""
    return [
        {
            "set": which, "leg": trial.plant.name, "seed": trial.plant.seed, "model": name,
            "position_hip_rad": float(trial.position[name][0]),
            "position_knee_rad": float(trial.position[name][1]),
            "torque_hip_Nm": float(trial.torque[name][0]),
            "torque_knee_Nm": float(trial.torque[name][1]),
            "found": " ".join(trial.found),
        }
        for name in trial.position
    ]  # fmt: skip


def curves(trial: Trial) -> Figure:
    """Measured over simulated where the chirp passes a few hertz, and the errors over the whole run."""
    with report.house_style():
        figure = Figure(figsize=(7.6, 6.0), layout="constrained")
        axes = figure.subplots(4, 2, sharex="row", height_ratios=[1.3, 1, 1.3, 1])
        for k, joint in enumerate(("hip", "knee")):
            measured = trial.measured[k]
            end = measured.time[-1]
            window = (0.62 * end, 0.86 * end)
            for row, (what, unit) in enumerate((("position", "rad"), ("torque", "N m"))):
                top, bottom = axes[2 * row, k], axes[2 * row + 1, k]
                shown = (measured.time >= window[0]) & (measured.time <= window[1])
                truth = getattr(measured, what)[:, k]
                top.plot(measured.time[shown], truth[shown], **LINES["measured"].drawn(), label="measured")
                for name in _CURVES:
                    values, look = getattr(trial.simulated[name][k], what)[:, k], LOOKS[NAMES[name]].drawn()
                    if name in ("kin_only", "s3n_full"):
                        top.plot(measured.time[shown], values[shown], **look)
                    bottom.plot(measured.time, values - truth, **look | {"lw": 0.9}, label=NAMES[name])
                top.set_title(f"{joint}: {what} [{unit}]")
                bottom.set_title(f"{joint}: simulated − measured [{unit}]")
                top.margins(x=0)
                bottom.margins(x=0)
                bottom.set_xlabel("time [s]")
        entries = {}
        for a in (axes[0, 0], axes[1, 0]):
            for handle, label in zip(*a.get_legend_handles_labels(), strict=True):
                entries.setdefault(label, handle)
        figure.legend(entries.values(), entries.keys(), loc="outside upper left", ncols=6)
    return figure


def summary(results: Sequence[tuple[str, Trial]]) -> Figure:
    """RMSE averaged over the joints by model, every trial a mark, sets side by side."""
    sets = list(dict.fromkeys(which for which, _ in results))
    with report.house_style():
        figure = Figure(figsize=(9.0, 3.4), layout="constrained")
        axes = np.atleast_2d(figure.subplots(1, 2 * len(sets), sharey=True))[0]
        rows = list(NAMES)
        for i, which in enumerate(sets):
            for j, (what, unit) in enumerate((("position", "mrad"), ("torque", "N m"))):
                a = axes[2 * i + j]
                for t in (t for w, t in results if w == which):
                    own = t.plant.name == "reference leg"
                    colour = COLOURS["after" if own else "before"][0]
                    errors = {n: e.mean() * (1e3 if j == 0 else 1.0) for n, e in getattr(t, what).items()}
                    a.plot(
                        list(errors.values()), [rows.index(n) for n in errors], "o" if own else "D",
                        ms=5 if own else 4, color=colour,
                        mfc=colour if own else "none", ls="",
                        label="reference leg" if own else "other legs",
                    )  # fmt: skip
                a.set_xscale("log")
                a.set_title(f"{which}:\n{what} [{unit}]")
                a.xaxis.set_minor_formatter(NullFormatter())
                a.set_yticks(range(len(rows)), list(NAMES.values()))
        axes[0].invert_yaxis()
        handles = {label: h for a in axes for h, label in zip(*a.get_legend_handles_labels(), strict=True)}
        figure.legend(handles.values(), handles.keys(), loc="outside upper left", ncols=2)
    return figure


if __name__ == "__main__":
    main()
