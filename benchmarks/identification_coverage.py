"""Do the intervals of identification hold the truth as often as they say? On virtual hardware, by seed.

    python benchmarks/identification_coverage.py --seeds 0 200

Each seed draws the sensors' noise of an actuator bench and of the leg (sum and difference multisines about a
knee angle of 60 degrees, in the loop of 3 ms), identifies both, and asks whether each 95 % interval holds the
truth and how far the estimate is from it.
"""

from __future__ import annotations

import argparse

import numpy as np
from joblib import Parallel, delayed
from scipy.stats import binom

from workbench import report
from workbench.core import Estimate, Excitation
from workbench.identification import identify_actuator, identify_leg
from workbench.report.layout import table
from workbench.rigs import VirtualLeg, multisine
from workbench.rigs.bench import VirtualBench

TRUTH = {
    "actuator J": 0.0162,
    "actuator B": 0.0972,
    "actuator T_d": 3e-3,
    "leg M11": 0.04793,
    "leg M12": 0.005413,
    "leg M22": 0.02368,
    "leg B hip": 0.0972,
    "leg B knee": 0.0972,
    "leg T_d": 3e-3,
}
_PERIOD, _LINES = 5.0, 500  # s; 0.2 to 100 Hz


def main() -> None:
    """Identify by seed, count, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs=2, default=(0, 200), metavar=("FIRST", "LAST"))
    parser.add_argument("--jobs", type=int, default=-1)
    arguments = parser.parse_args()
    seeds = range(*arguments.seeds)
    work = Parallel(n_jobs=arguments.jobs)(delayed(identified)(seed) for seed in seeds)
    rows: list[dict[str, Estimate]] = list(work)  # pyright: ignore[reportAssignmentType]
    low, high = (100.0 * binom.ppf(q, len(rows), 0.95) / len(rows) for q in (0.005, 0.995))
    out = table(
        "parameter", ("truth", "right"), ("worst error", "right"), ("bias", "right"), ("held", "right")
    )
    for name, truth in TRUTH.items():
        values = np.array([row[name].value for row in rows])
        inside = np.array([abs(row[name].value - truth) <= 1.96 * row[name].std for row in rows])
        out.add_row(
            name,
            f"{truth:g}",
            f"{100 * np.abs(values / truth - 1).max():.2f} %",
            f"{100 * (values.mean() / truth - 1):+.3f} %",
            f"{100 * inside.mean():.1f} %",
        )
    out.caption = f"{len(rows)} seeds; 99 % of honest 95 % intervals would be held {low:.1f} to {high:.1f} %"
    report.print_table(out)


def identified(seed: int) -> dict[str, Estimate]:
    """Estimates of one seed, by the names of `TRUTH`."""
    t, order = np.arange(25_000) * 1e-3, np.arange(1, _LINES + 1)
    phases = -np.pi * order * (order - 1) / _LINES
    tone = np.cos(2 * np.pi * np.outer(t, order) / _PERIOD + phases).sum(axis=1)
    excitation = Excitation("multisine", "single", _PERIOD, 1 / _PERIOD, _LINES / _PERIOD, "full")
    drive = identify_actuator(VirtualBench(seed).run({"multisine": 3.0 * tone / tone.std()}, excitation))
    trials = [multisine(mode, f_max=_LINES / _PERIOD, duration=21.0) for mode in ("sum", "difference")]
    leg = identify_leg(VirtualLeg(seed=seed).run(trials))
    found = (
        drive.inertia, drive.damping, drive.delay, leg.M11, leg.M12, leg.M22, *leg.damping, leg.delay,
    )  # fmt: skip
    return dict(zip(TRUTH, found, strict=True))


if __name__ == "__main__":
    main()
