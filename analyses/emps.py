"""A measured drive, from a bare mass to its friction: the EMPS benchmark of Janot, Gautier and Brunot.

    python analyses/emps.py data/emps/DATA_EMPS.mat --output out/emps

The control voltage times 35.15 N/V is the drive's force; the loop has no velocity sensor, so the
simulated controller differentiates the encoder, and the force is held from sample to sample.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import tomli_w

from workbench import compare, improve, load_model, load_recordings, report
from workbench.core.files import write_whole
from workbench.models import write_model


def description(table: Path) -> str:
    """The recording's TOML for the benchmark's MATLAB file."""
    force = {"column": "vir", "scale": 35.15}
    loop = {"kind": "cascade_pv", "kp": 160.18, "kv": 243.45, "gain": 35.15, "limit": 10.0, "period_s": 0.001}
    return tomli_w.dumps(
        {
            "format": 1,
            "name": "emps",
            "table": str(table.resolve()),
            "rig": "emps",
            "axes": ["slide"],
            "columns": {"time": "t", "position": "qm", "position_reference": "qg", "torque_command": force},
            "units": {"time": "s", "position": "m", "torque": "N"},
            "controller": loop,
            "excitation": {"kind": "reference"},
        }
    )


def main() -> None:
    """Improve the mass-only model, and write model, page and picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("table", type=Path, help="DATA_EMPS.mat")
    parser.add_argument("--output", type=Path, default=Path("out/emps"))
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    folder: Path = arguments.output
    write_whole(folder / "emps.toml", description(arguments.table), force=True)
    recordings = load_recordings([folder / "emps.toml"])
    result, better = improve(load_model("emps"), recordings, seed=arguments.seed)
    write_model(better, folder / "emps_improved.toml", force=True)
    report.print_table(report.improvement_table(result))
    report.print_table(report.compare_table(compare(better, recordings, seed=arguments.seed)))
    report.save_figure(report.ladder_figure(result), folder / "error_falling.png", force=True)
    command = f"python analyses/emps.py {arguments.table}"
    inputs = [folder / "emps.toml", arguments.table]
    report.write_page(
        result,
        folder / "report.html",
        command=command,
        inputs=inputs,
        seeds={"noise": arguments.seed},
        force=True,
    )


if __name__ == "__main__":
    main()
