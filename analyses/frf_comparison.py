"""Closed chain, serial variants and measurement: frequency responses of a parallel leg in one picture.

    python analyses/frf_comparison.py --output out/frf_comparison.png
    python analyses/frf_comparison.py --recordings sum.toml difference.toml

Without recordings of your own, the virtual leg is measured: a multisine on the sum and one on the difference
of the motors, about the knee angle of 60 degrees, in the loop of 3 ms, with the sensors' noise.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from workbench import load_model, load_recordings, report
from workbench.cli.frf_output import frf_table
from workbench.rigs import VirtualLeg, multisine
from workbench.verification import compare_frf, frf_figure

_F_MAX, _PERIOD, _DURATION = 100.0, 10.0, 61.0  # Hz, s, s: 0.1 to 100 Hz, six periods and a second


def main() -> None:
    """Measure, compare, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--model", default="leg")
    parser.add_argument("--recordings", type=Path, nargs="+")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--output", type=Path, default=Path("out/frf_comparison.png"))
    arguments = parser.parse_args()
    if arguments.recordings:
        recordings = load_recordings([str(path) for path in arguments.recordings])
    else:
        modes = ("sum", "difference")
        trials = [multisine(mode, f_max=_F_MAX, period=_PERIOD, duration=_DURATION) for mode in modes]
        recordings = VirtualLeg(seed=arguments.seed).run(trials)
    found = compare_frf(load_model(arguments.model), recordings)
    report.print_table(frf_table(found))
    report.save_figure(frf_figure(found[0]), arguments.output, force=True)
    print(f"Wrote {arguments.output}.")


if __name__ == "__main__":
    main()
