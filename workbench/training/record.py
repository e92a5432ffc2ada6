"""The verification record of a model: its checks and comparison, which training requires.

It stands beside the model's file (``leg.toml``, ``leg.record.json``) and goes stale when a file of the model
changes.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from workbench.comparison import compare
from workbench.core import InputError, Recording
from workbench.core.files import check_format, write_whole
from workbench.core.provenance import digest
from workbench.models import Model, read_model
from workbench.verification import verify

from .settings import library_versions

FORMAT = 1


class _Table(BaseModel):
    model_config = ConfigDict(extra="ignore", strict=True)


class _Check(_Table):
    name: str
    passed: bool


class _Compared(_Table):
    name: str


class _Record(_Table):
    """What is read of a record; the rest is there for people."""

    format: Literal[1]
    variant: str
    files: dict[str, str]
    checks: list[_Check]
    passed: bool
    recordings: list[_Compared]
    error: float
    noise_error: float
    consistent: bool


def record_path(model: Model) -> Path:
    """Return the path of the record of a model.

    Raises:
        InputError: the model was not read from a file.
    """
    if model.source is None:
        raise InputError(f"model '{model.name}' is in no file", remedy="write it first")
    return model.source.with_name(f"{model.source.stem}.record.json")


def make_record(
    model: Model, recordings: Sequence[Recording], *, samples: int = 50, seed: int = 0
) -> dict[str, Any]:
    """Return the record: the checks of a model against its closed chain, and its comparison with
    recordings.

    Args:
        model: the model.
        recordings: what was measured on the machine.
        samples: random postures and speeds of the check.
        seed: of those and of the noise simulations.
    """
    checked = verify(model, samples=samples, seed=seed)
    compared = compare(model, recordings, seed=seed)
    return {
        "format": FORMAT,
        "model": model.name,
        "variant": model.variant,
        "files": model.digests(),
        "checks": [{"name": c.name, "passed": c.passed} for c in checked.checks],
        "passed": checked.passed,
        "recordings": [
            {
                "name": r.recording.name, "error": r.error, "noise_error": r.noise_error,
                "sha256": digest(r.recording.source) if r.recording.source else None,
            }
            for r in compared.recordings
        ],
        "error": compared.error,
        "noise_error": compared.noise_error,
        "consistent": compared.consistent,
        "versions": library_versions(),
    }  # fmt: skip


def write_record(record: dict[str, Any], path: Path, *, force: bool = False) -> Path:
    """Write a record, complete or not at all."""
    return write_whole(path, json.dumps(record, indent=1) + "\n", force=force)


def read_record(path: Path) -> dict[str, Any] | None:
    """Return a record; None if there is none.

    Raises:
        InputError: the file is not a record.
    """
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        check_format(record, FORMAT, path)
        _Record.model_validate(record)
    except FileNotFoundError:
        return None
    except (OSError, ValueError, RecursionError) as error:
        key = None
        if isinstance(error, ValidationError):
            key = ".".join(map(str, error.errors()[0]["loc"]))
        raise InputError(
            "not a verification record", file=path, column=key, remedy="make it with `workbench approve`"
        ) from error
    return record


def model_of(record: dict[str, Any], path: Path) -> str:
    """Return the model of a record: the file beside it, otherwise the shipped model of that name.

    Args:
        record: as it was read.
        path: its file.

    Raises:
        InputError: no such model is there, or several are.
    """
    files, beside, folder = set(record["files"]), set[str](), path.absolute().parent
    for name in sorted(n for n in files if Path(n).suffix in (".toml", ".xml", ".urdf")):
        for file in (folder / name, Path(name).stem):
            try:
                model = read_model(file)
            except InputError:  # a tree or mechanism that the model is made of, or a file that is elsewhere
                continue
            if set(model.digests()) == files:
                beside.add(str(file))
                break
    if len(beside) == 1:
        return beside.pop()
    called = record.get("model") or "another model"
    raise InputError(
        f"the record is of '{called}', whose file is not beside it", file=path,
        remedy="name it: --model FILE, and --record for this file",
    )  # fmt: skip


def objections(record: dict[str, Any] | None, model: Model, variant: str) -> list[str]:
    """Return the reasons of its record why a model may not train policies; empty if it may."""
    if record is None:
        return ["the model has no verification record"]
    found = []
    now = model.digests()
    stale = sorted(name for name in {*now, *record["files"]} if now.get(name) != record["files"].get(name))
    if not {*now} & {*record["files"]}:
        found.append(f"the record is of model '{record.get('model')}', not of '{model.name}'")
    elif stale:
        found.append(f"the record is stale: {', '.join(stale)} changed since")
    if record.get("variant") != variant:
        found.append(f"the record is for variant {record.get('variant')}, not {variant}")
    if not record.get("passed"):
        found.append("a check against the closed chain failed")
    if not record.get("recordings"):
        found.append("the model was compared with no recording")
    elif not record.get("consistent"):
        found.append(
            f"its error is {record['error']:.3f}, and noise alone explains {record['noise_error']:.3f}"
        )
    return found


def summary(record: dict[str, Any]) -> str:
    """Return the record as one sentence."""
    done = sum(c["passed"] for c in record["checks"])
    names = ", ".join(r["name"] for r in record["recordings"])
    return (
        f"{done} of {len(record['checks'])} checks passed; compared with {names or 'nothing'}: "
        f"error {record['error']:.3f}, noise alone {record['noise_error']:.3f}"
    )
