"""MuJoCo's system identification and the diagnosis side by side, on the same recordings from the same start.

The toolbox, with its own defaults, fits one structure that it is given: armature, damping and dry friction
of both axes, six parameters, from measured torque to position. The diagnosis ranks its whole catalogue. Once
the structure is right (dry friction), once it is not (a torque constant off). Both see five recordings
of 53 s; then both models meet a sixth in the comparison, where one is the error of a perfect model.

    pip install 'mujoco[sysid]'
    python benchmarks/against_sysid.py
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from baselines.mujoco_sysid import EFFECTS, SIX, Fit, answer_of_fit, identify
from exam.answers import Answer, answer_of, error_of, with_answer, with_truth

from workbench.diagnosis import diagnose
from workbench.effects import load_model
from workbench.rigs import HiddenEffect, VirtualLeg, demo_experiments

CASES = {
    "structure right: dry friction of the knee's drive": HiddenEffect(
        "coulomb_friction", "knee", parameters={"torque": 0.25}
    ),
    "structure wrong: torque constant of the knee's drive": HiddenEffect(
        "torque_constant_error", "knee", parameters={"gain": 0.85}
    ),
}


@dataclass(frozen=True)
class Timed:
    """What a method gave, and the time that it took [s]."""

    result: Any
    wall: float
    cpu: float


@dataclass(frozen=True)
class Both:
    """What both gave, and errors on held-out motion over a perfect model's: before, and after each."""

    theirs: Timed
    ours: Timed
    before: float
    fitted: float
    diagnosed: float


def main() -> None:
    """Runs both on both cases and prints a table each."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=0, help="of the recordings' noise")
    parser.add_argument(
        "--integrator", default="implicitfast", choices=("implicitfast", "RK4"), help="of MuJoCo's side"
    )
    arguments = parser.parse_args()
    warm_up(arguments.seed)
    for title, hidden in CASES.items():
        print(f"\n## {title}: {dict(hidden.parameters)}\n", flush=True)
        print(side_by_side(hidden, arguments.seed, arguments.integrator), flush=True)


def warm_up(seed: int) -> None:
    """Both once on little: what is compiled or cached on first use is not what is compared."""
    (recording,) = VirtualLeg(seed=seed).run(demo_experiments(seed)[:1])
    diagnose(load_model("leg"), [recording], seed=seed)
    identify([recording], SIX[:1])


def measured(hidden: HiddenEffect, seed: int, integrator: str = "implicitfast") -> Both:
    """Both methods on one hidden effect."""
    *training, judge = VirtualLeg([hidden], seed=seed).run(demo_experiments(seed))
    model = load_model("leg")
    theirs = timed(lambda: identify(training, SIX, integrator))
    ours = timed(lambda: diagnose(model, training, seed=seed))
    floor = error_of(with_truth(model, [hidden]), [judge]) or float("nan")

    def over_floor(answer: Answer | None) -> float:
        after = error_of(model if answer is None else with_answer(model, answer), [judge])
        return float("nan") if after is None else after / floor

    answers = None, everything(theirs.result), answer_of(ours.result)
    before, fitted, diagnosed = (over_floor(answer) for answer in answers)
    return Both(theirs, ours, before, fitted, diagnosed)


def side_by_side(hidden: HiddenEffect, seed: int, integrator: str) -> str:
    """A table of what both say of one hidden effect."""
    both = measured(hidden, seed, integrator)
    theirs, ours = both.theirs, both.ours
    fit: Fit = theirs.result
    rows = [
        ["", "mujoco.sysid", "workbench diagnose"],
        ["---"] * 3,
        ["says", said_by_fit(fit), said(answer_of(ours.result))],
        [
            f"error on the sixth recording, perfect model 1, before {both.before:.2f}",
            f"{both.fitted:.2f}",
            f"{both.diagnosed:.2f}",
        ],
        ["structures tried", "1", str(len(ours.result.ranking))],
        ["wall time, ratio", "1", f"{ours.wall / theirs.wall:.2f}"],
        ["CPU time, ratio", "1", f"{ours.cpu / theirs.cpu:.2f}"],
        ["its own residual, after over before", f"{fit.residual[1] / fit.residual[0]:.2g}", "-"],
    ]
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def timed(work: Callable[[], Any]) -> Timed:
    """Runs `work` and takes its time."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = work()
    return Timed(result, time.perf_counter() - wall, time.process_time() - cpu)


def everything(fit: Fit) -> Answer:
    """All that was fitted, moved or not, as an answer."""
    return answer_of_fit(fit, only_moved=False)


def said_by_fit(fit: Fit) -> str:
    """Each parameter with its nominal value and its 95 % interval; in bold where it moved by more."""
    parts = []
    for (place, name), (nominal, value, half) in fit.values.items():
        text = f"{EFFECTS[name][0]}@{place[1]} {value - nominal:+.4g} ± {half:.2g}"
        parts.append(f"**{text}**" if abs(value - nominal) > half else text)
    return "; ".join(parts)


def said(answer: Answer) -> str:
    """Names with probability and 95 % intervals, or the verdict."""
    if not answer.named:
        return answer.verdict
    return "; ".join(
        f"**{each.key}** "
        + ", ".join(f"{name} {e.value:.4g} ± {1.96 * e.std:.2g}" for name, e in each.parameters.items())
        + (f" (probability {each.probability:.2f})" if each.probability is not None else "")
        for each in answer.named
    )


if __name__ == "__main__":
    main()
