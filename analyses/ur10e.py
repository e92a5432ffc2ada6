"""A measured six-axis arm, from its maker's masses to the friction and the rotors of every joint.

    python analyses/ur10e.py dynamic_calibration/dataset_ur10e --output out/ur10e

Logs of a UR10e that S. Mamedov and S. Mikhel published with "Practical Aspects of Model-Based Collision
Detection" (Frontiers in Robotics and AI, 2020; github.com/shamilmamedov/dynamic_calibration): positions,
speeds and motor currents at about 100 Hz. Two excitation motions are fitted, a third judges, and a
point-to-point motion that took part in neither is compared in the end.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import tomli_w
from matplotlib.figure import Figure
from rich.table import Table

from workbench import compare, improve, load_model, load_recordings, report
from workbench.comparison import replay_of
from workbench.core import Recording
from workbench.core.files import write_whole
from workbench.core.palette import LINES
from workbench.models import Model, write_model

AXES = ("pan", "lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
#: N m/A at the joint: the controller's target torque over its target current, in every log alike.
TORQUE_CONSTANT = (11.98, 11.98, 9.84, 10.76, 10.76, 11.33)
TRAINING = ("identification_data/ur-20_02_19_14harm50sec", "identification_data/ur-20_02_19_15harm50sec")
HELD_OUT = "identification_data/ur-20_02_12-50sec_12harm"
UNSEEN = "validation_data/ur-20_01_17-ptp_10_points"
_LOOKS = (("measured", "measured"), ("before", "masses alone"), ("after", "with what was found"))
_LAW = {"coulomb_friction": "torque", "viscous_damping": "damping", "reflected_inertia": "inertia"}


def recorded(log: Path, folder: Path) -> Path:
    """A recording of one of the logs, which have no header: time, positions, speeds, currents."""
    names = [f"{signal}_{axis}" for signal in ("q", "w", "i") for axis in AXES]
    table = pd.read_csv(log.with_suffix(".csv"), header=None, usecols=range(19), names=["t", *names])
    write_whole(folder / f"{log.name}.csv", table.to_csv(index=False), force=True)
    current = [{"column": f"i_{a}", "scale": k} for a, k in zip(AXES, TORQUE_CONSTANT, strict=True)]
    columns = {
        "time": "t",
        "position": [f"q_{a}" for a in AXES],
        "velocity": [f"w_{a}" for a in AXES],
        "torque_measured": current,
    }
    described = {
        "format": 1,
        "name": log.name,
        "table": f"{log.name}.csv",
        "rig": "ur10e",
        "coordinates": "joint",
        "axes": list(AXES),
        "columns": columns,
        "units": {"time": "s", "position": "rad", "velocity": "rad/s", "torque": "N*m"},
        "controller": {"kind": "unknown"},
        "excitation": {"kind": "reference"},
    }
    path = folder / f"{log.name}.toml"
    write_whole(path, tomli_w.dumps(described), force=True)
    return path


def found_table(model: Model, authors: Path) -> Table:
    """What was found of every axis, and the friction that the data's authors publish beside them."""
    published = authors_friction(authors)
    columns = ["Coulomb friction [N m]", "viscous damping [N m s/rad]", "rotor behind the gear [kg m2]"]
    table = Table("axis", *columns, "the authors' friction, damping")
    effects = {(e.key.effect, e.key.axis): e for e in model.effects}
    for k, axis in enumerate(AXES):
        cells = []
        for name, parameter in _LAW.items():
            applied = effects.get((name, axis))
            value = applied.parameters[parameter] if applied else None
            cells.append(f"{value.value:.3g} ± {2.0 * value.std:.1g}" if value else "-")
        beside = f"{published[k, 0]:.3g}, {published[k, 1]:.3g}" if published is not None else "-"
        table.add_row(axis, *cells, beside)
    return table


def authors_friction(path: Path) -> np.ndarray | None:
    """Coulomb friction and viscous damping (6, 2) from the authors' file, by the torque constants used here.

    They took the drives' gains as smaller, by a factor an axis that is in the same file.
    """
    if not path.is_file():
        return None
    rows = dict(line.split("=", 1) for line in path.read_text().splitlines() if "= [" in line)
    numbers = {k.strip(): np.array(v.strip(" [];").split(), float) for k, v in rows.items()}
    law = numbers["pi_frcn"].reshape(6, 3)[:, [1, 0]]
    return law * (np.array(TORQUE_CONSTANT) / numbers["drvGains"])[:, None]


def torque_figure(given: Model, better: Model, recording: Recording) -> Figure:
    """The torque of every axis over a motion that took part in nothing, measured and needed by the models."""
    replay = replay_of(given, [recording])
    runs = [replay.run([m])[0][0] for m in (given, better)]
    measured = replay.recordings[0]
    figure, axes = plt.subplots(3, 2, figsize=(11, 7), sharex=True, layout="constrained")
    for k, ax in enumerate(axes.T.flat):
        curves = zip(_LOOKS, (measured, *runs), strict=True)
        for (look, label), run in curves:
            ax.plot(run.time, run.signals["torque_measured"][:, k], **LINES[look].drawn(), label=label)
        ax.set(title=AXES[k], ylabel="torque [N m]")
    for ax in axes[-1]:
        ax.set(xlabel="time [s]")
    axes[0, 0].legend()
    return figure


def main() -> None:
    """Improve the rigid arm, and write model, page and picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("dataset", type=Path, help="folder with identification_data and validation_data")
    parser.add_argument("--output", type=Path, default=Path("out/ur10e"))
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    folder: Path = arguments.output
    files = [recorded(arguments.dataset / name, folder) for name in (*TRAINING, HELD_OUT, UNSEEN)]
    *training, held_out, unseen = load_recordings(files)
    given = load_model("ur10e")
    result, better = improve(given, training, [held_out], seed=arguments.seed)
    write_model(better, folder / "ur10e_improved.toml", force=True)
    report.print_table(report.improvement_table(result))
    report.print_table(found_table(better, arguments.dataset.parent / "UR10E_parameters.txt"))
    for model in (given, better):
        report.print_table(report.compare_table(compare(model, [unseen], seed=arguments.seed)))
    report.save_figure(torque_figure(given, better, unseen), folder / "torque.png", force=True)
    report.write_page(
        result,
        folder / "report.html",
        command=f"python analyses/ur10e.py {arguments.dataset}",
        inputs=files,
        seeds={"noise": arguments.seed},
        force=True,
    )


if __name__ == "__main__":
    main()
