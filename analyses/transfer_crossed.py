"""Every policy in every simulator, against the same runs of the hardware; and the table of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from transfer_paired import Spread, ladder
from transfer_picture import gaps_figure
from transfer_plants import SETS
from transfer_policies import SIMULATORS, TASK_FILES, Trained, policies_of
from transfer_robot import Robot
from transfer_runs import Job, Kept, Made
from transfer_tables import show, write_csv
from transfer_trials import run_trials
from transfer_worlds import EVALUATION, Law, Push

from workbench import report

AGAIN = "hardware again"
#: Values (U,) of the pairs, by simulator, and of the hardware's second run.
Values = dict[str, np.ndarray]


@dataclass(frozen=True)
class Study:
    """What was asked, and where runs and models are.

    Attributes:
        which: set of effects that the drives hide.
        seed: of the hardware's noise.
        out: folder.
        quick: short runs, one process.
        trained: training seeds.
        files: models of the simulators, by name.
    """

    which: str
    seed: int
    out: Path
    quick: bool
    files: dict[str, Path]
    trained: int = 5

    def policies(self, task: str, method: str | None = None) -> list[Trained]:
        """Those of a task, trained in one simulator or in all."""
        every = policies_of(task, self.trained, self.quick)
        return [p for p in every if method in (None, p.method)]

    def make(self, jobs: Sequence[Job]) -> list[Made]:
        """All runs, those that are new on all cores."""
        return run_trials(Kept(self.out / "runs"), jobs, serial=self.quick)

    def hardware(self, **more: Any) -> Robot:
        """The robot that hides this set."""
        return Robot(hidden=SETS[self.which], **more)

    def file(self, name: str) -> str:
        """Of a question, without its ending."""
        return f"{name}_{self.which.replace(' ', '_')}"


def crossed(
    study: Study, units: Sequence[Trained], seconds: float, robot: Robot, law: Law = EVALUATION,
    push: Push | None = None,
) -> tuple[list[Made], list[Made], dict[str, list[Made]]]:  # fmt: skip
    """Every policy on the hardware, there again, and in every simulator."""
    both: dict[str, Any] = {"push": push, "task": TASK_FILES.get(units[0].task)}
    jobs = [Job(seconds, study.seed + k, u.file, robot=robot, **both) for k in (0, 1) for u in units]
    plain = Robot(payload=robot.payload)
    jobs += [
        Job(seconds, 0, u.file, file, plain, law, **both) for file in study.files.values() for u in units
    ]
    made = study.make(jobs)
    n = len(units)
    each = [made[i : i + n] for i in range(0, len(made), n)]
    return each[0], each[1], dict(zip(study.files, each[2:], strict=True))


def collected(
    measures: Sequence[str], hardware: Sequence[Made], again: Sequence[Made],
    simulated: dict[str, list[Made]], gaps: Callable[[Made, Made], dict[str, float]],
) -> dict[str, Values]:  # fmt: skip
    """Gaps (U,) by measure and simulator, the hardware's second run among them where there is one."""
    runs = {**simulated, AGAIN: again} if again else simulated
    found = {name: [gaps(h, o) for h, o in zip(hardware, own, strict=True)] for name, own in runs.items()}
    return {m: {name: np.array([g[m] for g in own]) for name, own in found.items()} for m in measures}


def told(
    study: Study, name: str, title: str, pairs: int, measures: dict[str, str], values: dict[str, Values]
) -> None:
    """The table of a question, a line a measure; all numbers as CSV; and the picture."""
    rows = []
    for measure, unit in measures.items():
        label = f"{measure} [{unit}]" if unit else measure
        rows.append((label, *cells(study, values[measure], 2 if unit else 3), paired(study, values[measure])))
    table(study, name, title, pairs, rows, "paired")
    write_csv(study.out / f"{study.file(name)}.csv", [
        {"measure": m, "simulator": s, "pair": k, "value": float(x)}
        for m, own in values.items() for s, v in own.items() for k, x in enumerate(v)
    ])  # fmt: skip
    figure = gaps_figure(title, values, [*study.files, AGAIN])
    report.save_figure(figure, study.out / f"{study.file(name)}.png", force=True)


def paired(study: Study, values: Values) -> str:
    """Which neighbouring simulators a measure tells apart."""
    return ladder({SIMULATORS[s]: values[s] for s in study.files})


def table(study: Study, name: str, title: str, pairs: int, rows: Sequence[Sequence[str]], *more: str) -> None:
    """Print and write a table with a column a simulator."""
    columns = ("gap to the hardware", *(SIMULATORS[s] for s in study.files), AGAIN, *more)
    text = f"{title}: mean of {pairs} pairs ± half its 95 % interval"
    show(study.out, study.file(name), text, columns, rows)


def cells(study: Study, values: Values, digits: int = 2) -> list[str]:
    """A measure's values in each simulator, and the hardware's own second run."""
    return [Spread.of(values[s]).text(digits) if s in values else "" for s in (*study.files, AGAIN)]
