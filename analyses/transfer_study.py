"""Policies, or a jump, on the virtual quadruped and in simulators that know more and more of it.

    python analyses/transfer_study.py gait --out out/transfer

One table a question: ``gait`` (a lap of 0.8 m/s and 0.8 rad/s), ``pitch`` (in place, 5 Hz), ``jump`` (to
0.50 m, again and again), ``script`` (a jump without a policy), ``payload`` (the lap with 4 kg), ``push``
(from the side, on the lap), ``trot`` (1.8 m/s), ``contact`` (the law of the contact), ``damping`` (of that
law), ``robot`` (a hardware that is less ideal), ``estimator`` (of the velocity) and ``paper`` (every policy
in its own simulator alone). Every policy runs in every simulator, against the same hardware run; hardware
again is another run of it, with other noise. Runs and models are kept in the folder.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from trained_jump import APEX, PERIOD_S
from transfer_crossed import Study, Values, cells, collected, crossed, table, told
from transfer_jumps import JUMPED, JUMPS, jump_gaps
from transfer_laws import damping_table, laws_table
from transfer_measures import (
    GAIT,
    PITCH,
    PUSHED,
    SWING,
    gait_gaps,
    pitch_gaps,
    push_gaps,
    seen_by_filter,
    seen_by_legs,
    swing_misses,
)
from transfer_paper import paper_lap, paper_pitch
from transfer_plants import PARTS, SETS
from transfer_policies import about, simulators
from transfer_robot import Robot
from transfer_runs import Job, Made
from transfer_worlds import EVALUATION, Push

from workbench.training.machine import STEP_S
from workbench.training.quadruped import FOOT_RADIUS
from workbench.training.tasks import CIRCLE

_PUSH, _PUSHES = Push(50.0), 4
_TROT = 1.8, 0.0  # m/s, rad/s
_TROT_S = 4.0
_LAP_S = 2 * np.pi / CIRCLE[2]
_PITCH_S = 1.0 + 40 / 5.0
_ESTIMATORS: dict[str, Callable[[Made], Made]] = {
    "motion capture": lambda made: made,
    "leg odometry, foot a point": partial(seen_by_legs, radius=0.0),
    "leg odometry, radius known": partial(seen_by_legs, radius=FOOT_RADIUS),
    "Kalman filter, foot a point": partial(seen_by_filter, radius=0.0),
    "Kalman filter, radius known": partial(seen_by_filter, radius=FOOT_RADIUS),
}
_lap_gaps = partial(gait_gaps, command=(CIRCLE[0], CIRCLE[2]))


def main(arguments: Sequence[str] | None = None) -> dict[str, Values]:
    """Run, print, write; returns values (U,) by measure and simulator."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("question", choices=list(QUESTIONS))
    parser.add_argument("--out", type=Path, default=Path("out/transfer"))
    parser.add_argument("--seed", type=int, default=0, help="of recordings that models are built from; noise")
    parser.add_argument("--set", choices=list(SETS), default="clean", help="what the drives hide")
    parser.add_argument("--trained", type=int, default=5, help="training seeds of the policies")
    parser.add_argument("--models", type=Path, help="models that chirp_response.py left; else OUT/models")
    parser.add_argument("--quick", action="store_true", help="two policies, short runs, clean, nothing found")
    given = parser.parse_args(arguments)
    which = "clean" if given.quick else given.set
    files = simulators(which, given.seed, given.models or given.out / "models", given.quick)
    study = Study(which, given.seed, given.out, given.quick, files, given.trained)
    result = QUESTIONS[given.question](study)
    print(f"Contact in simulators: {EVALUATION}. {about(files)}")
    print(f"Wrote {given.out}.")
    return result


def gait(study: Study) -> dict[str, Values]:
    """The lap: all policies in all simulators."""
    runs = crossed(study, study.policies("circular"), _seconds(study), study.hardware())
    return _walked(study, "gait", f"A lap at 0.8 m/s and 0.8 rad/s, {study.which}", runs, _lap_gaps)


def trot(study: Study) -> dict[str, Values]:
    """Straight ahead at 1.8 m/s: policies of two levels of randomisation."""
    runs = crossed(study, study.policies("trot"), 2.0 if study.quick else _TROT_S, study.hardware())
    gaps = partial(gait_gaps, command=_TROT)
    return _walked(study, "trot", f"A trot at 1.8 m/s, {study.which}", runs, gaps)


def _walked(
    study: Study, name: str, title: str, runs: tuple[list[Made], list[Made], dict[str, list[Made]]],
    gaps: Callable[[Made, Made], dict[str, float]],
) -> dict[str, Values]:  # fmt: skip
    hardware, again, simulated = runs
    values = collected(list(GAIT), hardware, again, simulated, gaps)
    missed = {s: [swing_misses(h, file) for h in hardware] for s, file in study.files.items()}
    for measure in SWING:
        values[measure] = {s: np.array([m[measure] for m in own]) for s, own in missed.items()}
    told(study, name, title, len(hardware), GAIT | SWING, values)
    return values


def push(study: Study) -> dict[str, Values]:
    """The lap of S3N-Full's policies, pushed from both sides in turn."""
    units = study.policies("circular", "s3n_full")
    seconds = _PUSH.first_s + (2 if study.quick else _PUSHES) * _PUSH.every_s
    runs = crossed(study, units, seconds + STEP_S, study.hardware(), push=_PUSH)
    values = collected(list(PUSHED), *runs, partial(push_gaps, push=_PUSH))
    size = f"{_PUSH.force:g} N for {_PUSH.lasts_s:g} s"
    told(study, "push", f"Pushes of {size} on the lap, {study.which}", len(units), PUSHED, values)
    return values


def payload(study: Study) -> dict[str, Values]:
    """The lap with 4 kg that simulators know of: policies trained with loads."""
    robot = study.hardware(payload=4.0)
    runs = crossed(study, study.policies("payload"), _seconds(study), robot)
    title = f"A lap at 0.8 m/s and 0.8 rad/s with {robot.payload:g} kg, {study.which}"
    return _walked(study, "payload", title, runs, _lap_gaps)


def pitch(study: Study) -> dict[str, Values]:
    """Pitch in place: all policies in all simulators."""
    units = study.policies("pitch-in-place")
    hardware, again, simulated = crossed(study, units, 3.0 if study.quick else _PITCH_S, study.hardware())
    values = collected(list(PITCH), hardware, again, simulated, pitch_gaps)
    told(study, "pitch", f"Pitch in place, {study.which}", len(units), PITCH, values)
    return values


def jump(study: Study) -> dict[str, Values]:
    """Jumps to 0.50 m: policies of two levels of randomisation."""
    units = study.policies("jump")
    seconds = (1 if study.quick else JUMPS) * PERIOD_S
    values = collected(list(JUMPED), *crossed(study, units, seconds, study.hardware()), jump_gaps)
    told(study, "jump", f"Jumps to {APEX:.2f} m, {study.which}", len(units), JUMPED, values)
    return values


def script(study: Study) -> dict[str, Values]:
    """The scripted jump at several heights."""
    heights = (1.0,) if study.quick else tuple(np.linspace(0.7, 1.0, 7))
    jobs = [Job(0.0, study.seed + k, robot=study.hardware(), height=h) for k in (0, 1) for h in heights]
    jobs += [Job(0.0, 0, model=file, height=h) for file in study.files.values() for h in heights]
    made = study.make(jobs)
    hardware, again, *others = (made[i : i + len(heights)] for i in range(0, len(made), len(heights)))
    measures = {"apex": "mm", "take-off speed": "%"}

    def gaps(one: Made, other: Made) -> dict[str, float]:
        faster = 100.0 * abs(other.take_off / one.take_off - 1.0)
        return {"apex": 1e3 * abs(other.apex - one.apex), "take-off speed": faster}

    values = collected(list(measures), hardware, again, dict(zip(study.files, others, strict=True)), gaps)
    best = hardware[-1]
    title = f"A scripted jump, {study.which} (to {best.apex:.3f} m, off at {best.take_off:.2f} m/s)"
    told(study, "script", title, len(heights), measures, values)
    return values


def contact(study: Study) -> dict[str, Values]:
    """What the law of the contact does to the lap, S3N-Full's policies; the ground is that of the plate."""
    return laws_table(study, _seconds(study), _lap_gaps)


def damping(study: Study) -> dict[str, Values]:
    """The same with the law of the plate, and with more damping than it has."""
    return damping_table(study, _seconds(study), _lap_gaps)


def robot(study: Study) -> dict[str, Values]:
    """A hardware with one part more than its drawing; simulators know nothing of it."""
    units = study.policies("circular", "s3n_full")
    chosen = dict(list(PARTS.items())[:1]) if study.quick else PARTS
    out: dict[str, Values] = {}
    _, again, simulated = crossed(study, units, _seconds(study), Robot())
    for name, part in {"as drawn": Robot(), **chosen}.items():
        runs = study.make([Job(_seconds(study), study.seed, u.file, robot=part) for u in units])
        values = collected(list(GAIT), runs, again if name == "as drawn" else [], simulated, _lap_gaps)
        out[f"{name}: E_phi"], out[f"{name}: stride frequency"] = values["E_phi"], values["stride frequency"]
        out[f"{name}: swing leg's knee"] = {
            s: np.array([swing_misses(h, f)["swing leg's knee"] for h in runs])
            for s, f in study.files.items()
        }
    rows = [(f"{name} [%]", *cells(study, values)) for name, values in out.items()]
    title = "A robot that is less ideal, S3N-Full's policies on the lap"
    table(study, "robot", title, len(units), rows)
    return out


def estimator(study: Study) -> dict[str, Values]:
    """What the hardware's velocity is measured with, S3N-Full's policies on the lap."""
    units = study.policies("circular", "s3n_full")
    hardware, again, simulated = crossed(study, units, _seconds(study), Robot())
    out: dict[str, Values] = {}
    for name, seen in _ESTIMATORS.items():
        one, two = ([seen(h) for h in runs] for runs in (hardware, again))
        values = collected(["E_phi", "E_RMSE"], one, two, simulated, _lap_gaps)
        out |= {f"{name}: {m}": v for m, v in values.items()}
    rows = [(f"{name} [%]", *cells(study, values)) for name, values in out.items()]
    table(study, "estimator", "Who measures the velocity, S3N-Full's policies on the lap", len(units), rows)
    return out


def paper(study: Study) -> dict[str, Values]:
    """The paper's design: a policy in the simulator that it was trained in, and its numbers; two tables."""
    return {
        **paper_lap(study, _seconds(study)),
        **paper_pitch(study, 3.0 if study.quick else _PITCH_S),
    }


QUESTIONS: dict[str, Callable[[Study], dict[str, Values]]] = {
    f.__name__: f
    for f in (gait, pitch, jump, script, payload, push, trot, contact, damping, robot, estimator, paper)
}


def _seconds(study: Study) -> float:
    return (0.4 if study.quick else 1.0) * _LAP_S


if __name__ == "__main__":
    main()
