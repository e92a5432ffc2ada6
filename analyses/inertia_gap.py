"""The inertia that a serial tree leaves out of a parallel leg: by entry, by term, by posture.

    python analyses/inertia_gap.py --output out/inertia_gap.png

The table is the paper's (total equivalent inertia at alpha = 90 degrees); the picture shows it over alpha.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from workbench import load_model, report
from workbench.s3n.gap import inertia_gap
from workbench.verification.gap import gap_figure, papers_table, terms_table

_ALPHA = np.radians(np.linspace(0.0, 180.0, 181))


def main() -> None:
    """Compute, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--model", default="leg")
    parser.add_argument("--output", type=Path, default=Path("out/inertia_gap.png"))
    arguments = parser.parse_args()
    model = load_model(arguments.model)
    gap = inertia_gap(model, _ALPHA)
    report.print_table(papers_table(model))
    report.print_table(terms_table(gap))
    report.save_figure(gap_figure(gap), arguments.output, force=True)
    print(f"Wrote {arguments.output}.")


if __name__ == "__main__":
    main()
