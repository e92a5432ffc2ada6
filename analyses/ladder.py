"""From a serial tree to the closed chain: what a parallel leg's model lacks, step by step.

    python analyses/ladder.py --output docs/images/ladder.png

Data come from the virtual leg (a closed chain in Drake); the model starts as the Jacobian-mapping
baseline (Kin-Only). Each step is found, added, and judged on a recording that was not fitted.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from workbench import improve, load_model, report
from workbench.rigs import VirtualLeg, demo_experiments


def main() -> None:
    """Record, climb, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--output", type=Path, default=Path("out/ladder.png"))
    parser.add_argument("--json", type=Path, help="the steps as JSON of `workbench improve`")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    recordings = VirtualLeg(seed=arguments.seed).run(demo_experiments(arguments.seed))
    training = [r for r in recordings if r.name != "validation"]
    judge = [r for r in recordings if r.name == "validation"]
    result, _ = improve(load_model("leg_kin_only"), training, judge, seed=arguments.seed)
    report.print_table(report.improvement_table(result))
    report.save_figure(report.ladder_figure(result), arguments.output, force=True)
    if arguments.json:
        report.write_json(report.improvement_dict(result), arguments.json, force=True)


if __name__ == "__main__":
    main()
