"""How often the demonstration names the effect that is hidden: one line a seed, and a summary.

python benchmarks/hidden_effects.py --seeds 100 120          # hidden effects
python benchmarks/hidden_effects.py --seeds 100 120 --clean  # nothing hidden
python benchmarks/hidden_effects.py --seeds 0 8 --outsider   # effects that no catalogue lists
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

from workbench.core import EffectKey
from workbench.diagnosis import improve
from workbench.effects import load_model
from workbench.recordings import load_recordings
from workbench.rigs import HiddenEffect, VirtualLeg, demo_experiments, draw_hidden

#: Outsiders at sizes that raise the error severalfold.
_OUTSIDE = (
    HiddenEffect("periodic_disturbance", "knee", parameters={"torque": 0.4, "frequency": 3.7, "phase": 0.3}),
    HiddenEffect("cubic_spring", "hip", parameters={"stiffness": 3.0, "rest": -0.2}),
    HiddenEffect("random_walk_torque", "hip", parameters={"torque": 0.4, "time_constant": 0.3}),
    HiddenEffect(
        "position_dependent_friction", "knee", parameters={"torque": 0.3, "order": 6.0, "phase": 0.4}
    ),
)


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", nargs=2, type=int, default=(0, 4), metavar=("FIRST", "END"))
    parser.add_argument("--clean", action="store_true")
    parser.add_argument("--outsider", action="store_true")
    arguments = parser.parse_args()
    good, total = 0, 0
    for seed in range(*arguments.seeds):
        hidden = () if arguments.clean else (draw_hidden(seed),)
        if arguments.outsider:
            hidden = (_OUTSIDE[seed % len(_OUTSIDE)],)
        started = time.perf_counter()
        good += one(seed, hidden, known=not arguments.outsider)
        total += 1
        print(f"      {time.perf_counter() - started:.0f} s", flush=True)
    print(f"{good} of {total} right")


def one(seed: int, hidden: tuple[HiddenEffect, ...], *, known: bool) -> bool:
    """One case; whether the answer is right."""
    with tempfile.TemporaryDirectory() as folder:
        files = VirtualLeg(hidden, seed=seed).record_to(Path(folder), demo_experiments(seed))
        names = [str(f) for f in files]
        held_out = load_recordings([n for n in names if "validation" in n])
        training = load_recordings([n for n in names if "validation" not in n])
        result, _ = improve(load_model("leg"), training, held_out, seed=seed)
    truth = [EffectKey(h.effect, h.axis, h.location) for h in hidden]
    steps = [s for s in result.steps if s.key not in {k for t in result.steps for k in t.removed}]
    named = {k for s in steps for k in (s.key, *s.indistinguishable_from)}
    right = set(truth) <= named and len(steps) == len(truth) if known else not steps
    print(
        f"{seed:5d} {'ok  ' if right else 'MISS'} {result.verdict:12s} "
        f"{result.error_before / result.noise_error:6.2f} -> "
        f"{result.error_after / result.noise_error:5.2f} x noise  "
        f"truth {', '.join(map(str, truth)) or 'nothing'} {[dict(h.parameters) for h in hidden]}  found "
        + "; ".join(
            f"{s.key} { {k: f'{e.value:.4g}+-{e.std:.2g}' for k, e in s.parameters.items()} }"
            for s in result.steps
        )
        + (
            f"  look-alikes {[str(k) for s in steps for k in s.indistinguishable_from]}"
            if named - set(truth)
            else ""
        )
    )
    if not result.steps and result.diagnosis:
        print("      ranking", [(str(k), round(v, 3)) for k, v in result.diagnosis.ranking[:6]])
    return right


if __name__ == "__main__":
    main()
