"""``workbench import`` of a table or log: findings are shown, and what is unknown is asked."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workbench.core import InputError

from .common import check_outputs, named_values, write_result, wrote
from .import_ask import answered

if TYPE_CHECKING:
    from workbench.inspection import Inspection
    from workbench.proposing import Answers, Proposal


def import_table(
    path: Path,
    output: str,
    answers: Answers,
    *,
    yes: bool = False,
    model: str | None = None,
    json: str | None = None,
    force: bool = False,
    quiet: bool = False,
) -> None:
    """Propose, ask, write, and show.

    Raises:
        InputError: the file cannot be read, or a question is open and nobody is there to ask.
    """
    if told := _imported(path, output, answers, yes, model, json, force, quiet)[1]:
        wrote(told)


def _imported(
    path: Path, output: str, answers: Answers, yes: bool, model: str | None, json: str | None, force: bool,
    quiet: bool,
) -> tuple[Answers, str]:  # fmt: skip
    """Import one log; return the answers with what was asked, and what to tell once its files are there."""
    from workbench import report
    from workbench.core.files import together
    from workbench.effects import load_model
    from workbench.inspection import inspect
    from workbench.models import read_model
    from workbench.proposing import complete, open_table, told, write

    from .import_check import with_model

    target = Path(output) if output else default_output(path)
    check_outputs(str(target), force=force)
    table = open_table(path, episode=answers.episode or 0)
    silent = quiet or json == "-"
    proposal, answers = told(
        table,
        answers,
        lambda proposal, asked, now: answered(proposal, asked, now, table, yes=yes, silent=silent),
        model=load_model(model) if model else None,
        likeliest=yes,
    )
    proposal, recording = complete(proposal, table, answers)
    found = inspect(recording)
    if model:
        found = with_model(found, model, recording)
    with together():
        written = write(proposal, table, target, force=force)
        if json:
            read = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
            read += read_model(model).files if model else []
            write_result(proposal_dict(proposal, written, found), json, files=read, force=force)
    if silent:
        return answers, ""
    from workbench.inspection.inspect import FEW

    from .import_next import next_step
    from .import_tables import proposal_tables

    report.print_table(proposal_tables(proposal, recording, found))
    remarks = found.recordings[0].remarks
    looped = bool(proposal.description.get("controller")) or (
        answers.loop and "position_reference" in recording.signals
    )
    short = len(recording) < FEW
    told = next_step(proposal.description, remarks, target, model, short=short, looped=looped)
    return answers, f"Wrote {' and '.join(map(str, written))}.\n{told}"


def import_several(
    paths: Sequence[Path],
    folder: str,
    answers: Answers,
    *,
    yes: bool = False,
    model: str | None = None,
    json: str | None = None,
    force: bool = False,
    quiet: bool = False,
) -> None:
    """Import similar logs, all or none of them: an answer for one log holds for the following ones.

    Args:
        paths: the logs, in order.
        folder: where the recordings go; beside each log where it is empty.

    Raises:
        InputError: as `import_table`; two logs would have one recording; or JSON, which is of one log.
    """
    from workbench.core.files import together

    if json:
        raise InputError("--json is of one log", remedy="import one at a time, or omit --json")
    if folder and Path(folder).suffix:
        raise InputError(
            "several logs do not go into one file", file=folder,
            remedy="name a folder with -o, or omit -o",
        )  # fmt: skip
    targets = [Path(folder) / default_output(p).name if folder else default_output(p) for p in paths]
    for target in targets:
        if targets.count(target) > 1:
            raise InputError(
                "two logs would have this one recording", file=target, remedy="import them one by one"
            )
        check_outputs(str(target), force=force)
    told: list[str] = []
    with together():
        for path, target in zip(paths, targets, strict=True):
            answers, line = _imported(path, str(target), answers, yes, model, None, force, quiet)
            told.append(line)
    if not quiet:
        wrote("\n".join(told))


def default_output(path: Path) -> Path:
    """``run.toml`` beside ``run.csv``; for a folder ``folder.toml`` beside it."""
    name = path.name
    for ending in (".gz", *path.suffixes[::-1]):
        if name.lower().endswith(ending.lower()) and name != ending and not path.is_dir():
            name = name[: -len(ending)]
    return path.with_name(f"{name or path.name}.toml")


def read_answers(
    axis: list[str] | None,
    column: list[str] | None,
    unit: list[str] | None,
    rate: float | None,
    counts: float | None,
    coordinates: str,
    kp: list[float] | None,
    kd: list[float] | None,
    period: float | None,
    model: str | None,
    episode: int | None,
) -> Answers:
    """Return the answers that the options give.

    Raises:
        InputError: an option that is not of its form, or a model that cannot be read.
    """
    from workbench.effects import load_model
    from workbench.proposing import Answers, said_by

    if coordinates not in ("", "actuator", "joint"):
        raise InputError(f"--coordinates '{coordinates}' is neither 'actuator' nor 'joint'")
    for value, option in ((rate, "--rate"), (counts, "--counts"), (period, "--period")):
        if value is not None and not 0 < value < float("inf"):
            raise InputError(f"{option} must be positive", remedy="give a finite number above zero")
    columns = {k: tuple(v.split(",")) for k, v in named_values(column, "--column", "position=q1,q2").items()}
    return Answers(
        axes=tuple(axis or ()),
        columns={k: tuple(part.strip() for part in v) for k, v in columns.items()},
        units=named_values(unit, "--unit", "position=deg,deg,mm,deg"),
        coordinates=coordinates,
        rate_hz=rate,
        counts=counts,
        kp=tuple(kp or ()),
        kd=tuple(kd or ()),
        period_s=period,
        episode=episode,
        **({} if model is None else said_by(load_model(model))),
    )


def proposal_dict(proposal: Proposal, written: list[Path], found: Inspection) -> dict[str, Any]:
    """Return the result for programs."""
    return {
        "format": 1,
        "files": [str(file) for file in written],
        "recording": dict(proposal.description),
        "assumptions": [
            {"what": a.what, "value": a.value, "probability": a.sure, "because": a.because}
            for a in proposal.assumptions
        ],
        "notes": list(proposal.notes),
        "problems": [r.text for r in found.recordings[0].remarks if r.severity in ("problem", "warning")],
    }
