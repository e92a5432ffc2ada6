"""One case through the diagnosis and, if wanted, other methods: a dictionary that JSON can hold."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from limits import TooLong, at_most

from workbench.comparison import compare
from workbench.core import InputError, Recording, SimulationError
from workbench.diagnosis import diagnose
from workbench.models import Model

from . import scoring
from .answers import Answer, Named, answer_of, error_of, errors_of, key_of, with_answer, with_truth
from .cases import Case
from .field.judging import judged, refused
from .field.plant import told
from .record import Recorded, record

#: Training recordings and seed -> answer.
Method = Callable[[Sequence[Recording]], Answer]

VISIBLE = 2.0  # error over noise


def mark(
    case: Case,
    others: Mapping[str, Method],
    revision: str = "",
    marks: Mapping[str, Any] | None = None,
    patience: float = 900.0,
    again: bool = False,
) -> dict[str, Any]:
    """Makes the recordings, asks everyone, and marks the answers.

    Args:
        case: the question.
        others: further methods by name; each is asked on the training recordings alone.
        revision: of the code, kept with the marks.
        marks: of this case already, to which only the others' are added.
        patience: the diagnosis has failed if it takes longer [s]; only a process's main thread can tell.
        again: whether the model with all that was named is diagnosed too, to which nothing may be added.
    """
    with TemporaryDirectory() as folder:
        if marks is None:
            return _diagnosed(case, others, revision, patience, again, Path(folder))
        data = record(case, Path(folder))
        new = {name: _asked(case, ask, data, marks) for name, ask in others.items()}
        return {**marks, "others": {**marks["others"], **new}}


def _diagnosed(
    case: Case, others: Mapping[str, Method], revision: str, patience: float, again: bool, folder: Path
) -> dict[str, Any]:
    line: dict[str, Any] = {
        "case": case.name,
        "kind": case.kind,
        "seed": case.seed,
        "size": case.size,
        "recorded": case.recorded,
        "revision": revision,
        "truth": [
            {"effect": h.effect, "axis": h.axis, "location": h.location, "parameters": dict(h.parameters)}
            for h in case.hidden
        ],
    }
    try:
        data = record(case, folder)
    except SimulationError as error:
        return {**line, "failed": f"rig: {error}"}
    model = data.model
    wall, cpu = time.perf_counter(), time.process_time()
    try:
        with at_most(patience):
            diagnosis = diagnose(model, data.training, data.held_out, seed=case.seed)
    except InputError as error:
        return {**line, **_spent(wall, cpu), **refused(case.kind, str(error))}
    except (Exception, TooLong) as error:  # what a user would see as a crash is a mark too
        return {**line, "failed": f"diagnosis: {type(error).__name__}: {error}"}
    line |= _spent(wall, cpu)
    line["work"] = float(diagnosis.work)
    line["moves"] = [tried.move for tried in diagnosis.trace if tried.taken]
    before = compare(model, data.training, draws=4)
    judging = data.held_out or data.training
    known = case.kind != "outsider"
    line["error"], line["noise_error"] = float(before.error), float(before.noise_error)
    line["visible"] = bool(before.error >= VISIBLE * before.noise_error)
    line["before"] = error_of(model, judging) if data.held_out else float(before.error)
    truth = with_truth(model, case.hidden)
    training = told(case.field, data.training) if case.field else data.training
    judging = told(case.field, judging) if case.field else judging
    line["floor"], line["floor_noise"] = errors_of(truth, judging) if known else (None, None)
    line["asked"] = _asked_for(case, model, training)
    line |= marked(case, answer_of(diagnosis), line)
    if case.field is not None:
        line |= judged(case.field, case.kind, line, diagnosis)
    if again and diagnosis.findings:
        improved = with_answer(model, answer_of(diagnosis))
        second = diagnose(improved, data.training, data.held_out, seed=case.seed)
        line["again"] = [str(f.key) for f in second.findings]
    line["error_stated"], line["noise_stated"] = float(diagnosis.error), float(diagnosis.noise_error)
    line["unexplained_fraction"] = float(diagnosis.unexplained_fraction)
    line["ranking"] = [[str(key), round(float(share), 4)] for key, share in diagnosis.ranking[:6]]
    line["evidence"] = list(diagnosis.evidence)
    line["notes"] = list(diagnosis.notes)
    line["near"] = [str(f.key) for f in diagnosis.near]
    line["not_excited"] = [str(key) for key in diagnosis.not_excited]
    line["next_experiment"] = diagnosis.next_experiment
    line["others"] = {name: _asked(case, ask, data, line) for name, ask in others.items()}
    return line


def _asked(
    case: Case,
    ask: Method,
    data: Recorded,
    line: Mapping[str, Any],
) -> dict[str, Any]:
    """Another method's marks; its model is put through the same comparison."""
    wall, cpu = time.perf_counter(), time.process_time()
    try:
        answer = ask(data.training)
    except Exception as error:
        return {"failed": f"{type(error).__name__}: {error}"}
    spent = _spent(wall, cpu)
    judging = data.held_out or data.training
    after = error_of(with_answer(data.model, answer), judging) if answer.named else None
    return spent | marked(case, Answer(answer.verdict, answer.named, after), line)


def _spent(wall: float, cpu: float) -> dict[str, float]:
    """Time since two clocks showed these [s]."""
    return {
        "wall_s": round(time.perf_counter() - wall, 2),
        "cpu_s": round(time.process_time() - cpu, 2),
    }


def _asked_for(case: Case, model: Model, training: Sequence[Recording]) -> list[str]:
    """What has to be named: of several hidden effects those without which the true model fails visibly.

    Beside a stranger the true model fails already: what counts is what comes to that.
    """
    if len(case.hidden) < 2:
        return [str(key_of(h)) for h in case.hidden]
    whole = errors_of(with_truth(model, case.hidden), training)[0] if case.field else None
    asked = []
    for h in case.hidden:
        rest = with_truth(model, [other for other in case.hidden if other is not h])
        error, noise = errors_of(rest, training)
        if error is None or noise is None or error**2 >= (whole or noise) ** 2 + (VISIBLE**2 - 1) * noise**2:
            asked.append(str(key_of(h)))
    return asked


def marked(case: Case, answer: Answer, line: Mapping[str, Any]) -> dict[str, Any]:
    """Outcome and numbers of one answer; `line` has the errors before and of the true model."""
    known = case.kind != "outsider"
    truth = [key_of(h) for h in case.hidden] if known else []
    asked = [key for key in truth if str(key) in line["asked"]]
    match = scoring.matches(truth, answer, line["floor"])
    result, found = scoring.outcome(truth, answer, match, asked), [each.how for each in match]
    after = answer.error_after if answer.named else line["before"]
    return {
        "verdict": answer.verdict,
        "outcome": result,
        "good": scoring.good(case.kind, result, line["visible"]),
        "first_right": bool(found and found[0] == "right"),
        "false_findings": found.count("false"),
        "after": after,
        "removed": scoring.removed(line["before"], after, line["floor"]),
        "findings": [_finding(named, how, case) for named, how in zip(answer.named, found, strict=True)],
    }


def _finding(named: Named, how: str, case: Case) -> dict[str, Any]:
    own = [h for h in case.hidden if scoring.canonical(key_of(h)) == scoring.canonical(named.key)]
    values = own[0].parameters if own and how == "right" else {}
    return {
        "key": str(named.key),
        "effect": named.key.effect,
        "axis": named.key.axis,
        "location": named.key.location,
        "is": how,
        "probability": named.probability,
        "also": [str(key) for key in named.also],
        "parameters": {
            name: {
                "value": float(estimate.value),
                "std": float(estimate.std),
                "truth": values.get(name),
                "covered": scoring.covered(name, values[name], estimate.value, estimate.std)
                if name in values
                else None,
            }
            for name, estimate in named.parameters.items()
        },
    }


def revision() -> str:
    """The code's commit, with a plus where it was changed since; empty where there is no git."""
    folder = Path(__file__).parent

    def git(*arguments: str) -> str:
        return subprocess.run(
            ["git", *arguments], cwd=folder, capture_output=True, text=True, check=True
        ).stdout.strip()

    try:
        return git("rev-parse", "--short", "HEAD") + ("+" if git("status", "--porcelain", "-uno") else "")
    except (OSError, subprocess.CalledProcessError):
        return ""
