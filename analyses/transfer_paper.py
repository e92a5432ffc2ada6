"""The paper's own design: a policy in the simulator that it was trained in, and the paper's numbers.

The paper injects what S3N-Act and S3N-Full add as torques from the step before, and trains so. Here
`explicit` does; all others have it in the inertia of the simulator.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from transfer_crossed import AGAIN, Study, Values, collected
from transfer_measures import gait_gaps, pitch_gaps
from transfer_paired import Spread
from transfer_policies import INJECTED, Trained, policies_of
from transfer_robot import Robot
from transfer_runs import Job, Made
from transfer_tables import show
from transfer_worlds import EVALUATION, TRAINED, TRAINING, ContactLaw

from workbench.training.tasks import CIRCLE

#: Method -> name, and the paper's E_phi and E_RMSE of a lap [%], its force on a foot in pitch in place [N].
PAPER = {
    "kin_only": ("Kin-Only", "17.3, 19.46", "27.1"),
    "kin_only_hr": ("Kin-Only HR", "21.5, 24.17", "–"),
    "s3n_act": ("S3N-Act", "15.7, 18.26", "9.5"),
    "s3n_full": ("S3N-Full", "9.9, 12.23", "10.2"),
    INJECTED: ("S3N-Full, injected", "9.9, 12.23", "10.2"),
}
#: Rows of a table: method, and the contact and steps of the simulator that it is compared with.
Rows = tuple[tuple[str, ContactLaw], ...]
_BOTH = ("s3n_full", INJECTED)
_PITCH: Rows = (*((method, EVALUATION) for method in PAPER), *((method, TRAINING) for method in _BOTH))
_LAP: Rows = (*_PITCH, (INJECTED, TRAINED))


def paper_lap(study: Study, seconds: float) -> dict[str, Values]:
    """The paper's table of circular locomotion."""
    title = "A lap, each policy in its own simulator"
    gaps = partial(gait_gaps, command=(CIRCLE[0], CIRCLE[2]))
    return _own(study, "circular", "paper", title, seconds, ("E_phi", "E_RMSE"), "%", gaps, _LAP)


def paper_pitch(study: Study, seconds: float) -> dict[str, Values]:
    """The paper's numbers of pitch in place."""
    title = "Pitch in place, each policy in its own simulator"
    measure = ("force on a foot, RMSE",)
    return _own(study, "pitch-in-place", "paper_pitch", title, seconds, measure, "N", pitch_gaps, _PITCH)


def _own(
    study: Study, task: str, name: str, title: str, seconds: float, measures: Sequence[str], unit: str,
    gaps: Callable[[Made, Made], dict[str, float]], wanted: Rows,
) -> dict[str, Values]:  # fmt: skip
    units = [*study.policies(task), *policies_of(task, study.trained, study.quick, (INJECTED,))]
    rows = [(method, law) for method, law in wanted if any(u.method == method for u in units)]
    robot = study.hardware()
    real = [Job(seconds, study.seed + k, u.file, robot=robot) for k in (0, 1) for u in units]
    own = [_job(study, seconds, u, law) for method, law in rows for u in units if u.method == method]
    made = study.make([*real, *own])
    hardware, again, simulated = made[: len(units)], made[len(units) : len(real)], iter(made[len(real) :])
    lines, out = [], {}
    for method, law in rows:
        mine = [k for k, u in enumerate(units) if u.method == method]
        runs = {method: [next(simulated) for _ in mine]}
        one, two = ([all_[k] for k in mine] for all_ in (hardware, again))
        found = collected(list(measures), one, two, runs, gaps)
        step = f"{1e3 * law.time_constant_s:g} ms, {1e3 * law.step_s:g} ms"
        shown = [Spread.of(found[m][s]).text() for m in measures for s in (method, AGAIN)]
        lines.append((PAPER[method][0], step, *shown, PAPER[method][1 if len(measures) > 1 else 2]))
        out |= {f"{method}, {step}: {m}": v for m, v in found.items()}
    heads = [head for m in measures for head in (f"{m} [{unit}]", "again")]
    theirs = f"paper: {', '.join(measures)}"
    columns = ("trained and simulated in", "contact, steps", *heads, theirs)
    text = f"{title}, {study.which}: mean over training seeds ± half its 95 % interval"
    show(study.out, study.file(name), text, columns, lines)
    return out


def _job(study: Study, seconds: float, unit: Trained, law: ContactLaw) -> Job:
    injected = unit.method == INJECTED
    model = study.files["s3n_full" if injected else unit.method.removesuffix("_hr")]
    return Job(seconds, 0, unit.file, model, Robot(), law, variant=INJECTED if injected else None)
