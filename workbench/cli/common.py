"""What commands share: reading inputs, progress, and where results go."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from glob import glob
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from workbench.core import InputError, Recording
from workbench.core.files import check_apart, check_free, check_place, together, when_written
from workbench.core.text import plain

if TYPE_CHECKING:
    from workbench.models import Model
    from workbench.recordings import Excerpts, Log


def echo(text: str, *, err: bool = False) -> None:
    """Print lines; text from files is printed as it is, without markup."""
    typer.echo("\n".join(map(plain, text.split("\n"))), err=err)


def wrote(text: str) -> None:
    """Print lines that say what was written, and what follows from it, once the files are in their places."""
    when_written(lambda: echo(text))


def read_recordings(paths: Sequence[str]) -> list[Recording]:
    """Return the recordings; each file may be named once.

    Raises:
        InputError: one of them is bad, or stands twice.
    """
    from workbench.recordings import load_recordings

    return load_recordings(_without_models(paths))


def _without_models(paths: Sequence[str]) -> list[str]:
    """Return files, each given once, without models (as ``*.toml`` finds them); a note names these."""
    from workbench.recordings import is_model_file

    paths = [file for path in paths for file in found(path)]
    models = [p for p in paths if is_model_file(Path(p))]
    if models and len(models) < len(paths):
        what = "is a model, not a recording" if len(models) == 1 else "are models, not recordings"
        echo(f"note: {', '.join(models)} {what}: left out", err=True)
        paths = [p for p in paths if p not in models]
    _each_once(paths)
    return list(paths)


def found(path: str) -> list[str]:
    """Return the files of a pattern that the shell left as it is; any other path alone."""
    return (not os.path.exists(path) and sorted(glob(path, recursive=True))) or [path]


def _each_once(paths: Sequence[str]) -> None:
    resolved = [Path(p).resolve() for p in paths]
    twice = [p for p, r in zip(paths, resolved, strict=True) if resolved.count(r) > 1]
    if twice:
        raise InputError("the recording is given twice", file=twice[0], remedy="name each recording once")


def open_sources(paths: Sequence[str], *, whole: bool = False) -> list[Recording | Log]:
    """Return recordings, and sources for logs too long for the memory (none if `whole`); each file once.

    Raises:
        InputError: one of them is bad, or stands twice.
    """
    from workbench.recordings import open_recordings

    return open_recordings(_without_models(paths), whole=whole)


def open_pair(training: Sequence[str], held_out: Sequence[str] | None, *, whole: bool) -> Excerpts:
    """Return recordings to fit and to test; long logs are cut into windows unless `whole` is set.

    Raises:
        InputError: one of them is bad, or is given for both.
    """
    from workbench.recordings import excerpts

    _each_once([*training, *(held_out or [])])
    judging = open_sources(held_out, whole=whole) if held_out else []
    return excerpts(open_sources(training, whole=whole), judging)


def whole(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command whose files all appear at its end, or none where it fails; exit code 1 is no failure.

    Not for those that read their own files, or that keep what they have where they are interrupted.
    """

    @wraps(command)
    def run(*args: Any, **options: Any) -> None:
        ended = None
        with together():
            try:
                command(*args, **options)
            except typer.Exit as code:
                ended = code
        if ended is not None:
            raise ended

    return run


def check_outputs(*paths: str | None, force: bool) -> None:
    """Refuse outputs that exist or cannot be written, before anything is computed."""
    for path in paths:
        if path and path != "-":
            check_free(path, force=force)
            check_place(path)


def keep_inputs(outputs: Sequence[str | None], files: Sequence[Path]) -> None:
    """Refuse outputs that would overwrite a file that was read; `--force` is not meant for these.

    Args:
        outputs: as they were named; None and ``-`` are no files.
        files: all that was read.

    Raises:
        InputError: one of the outputs is one of the files.
    """
    for path in outputs:
        if path and path != "-":
            check_apart(path, files)


def named_values(texts: Sequence[str] | None, option: str, example: str) -> dict[str, str]:
    """Return the value of each name that a repeatable option gives.

    Args:
        texts: ``NAME=VALUE`` each.
        option, example: for the error, as ``--unit`` and ``position=deg``.

    Raises:
        InputError: one has no name or no value, or a name stands twice.
    """
    out: dict[str, str] = {}
    for text in texts or ():
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError(f"{option} '{text}' is not NAME=VALUE", remedy=f"e.g. {option} {example}")
        if name in out:
            raise InputError(
                f"{option} {name} is given twice", remedy=f"give it once, e.g. {option} {example}"
            )
        out[name] = value
    return out


def check_model_output(path: str | None, *, force: bool) -> None:
    """Refuse a model file that exists, or that could not be read back under its name."""
    if path and Path(path).suffix.lower() != ".toml":
        remedy = "call it .toml; --into ROBOT writes numbers into a copy of your .xml or .urdf"
        raise InputError("a model with effects is written as TOML", file=path, remedy=remedy)
    check_outputs(path, force=force)


def write_result(
    content: Mapping[str, Any],
    json: str,
    *,
    files: Sequence[Path],
    seeds: Mapping[str, int] | None = None,
    force: bool,
) -> None:
    """Write JSON with its provenance; a revealed truth comes last."""
    from workbench import report
    from workbench.core.provenance import provenance

    keep_inputs([json], files)
    made = {"provenance": provenance(files, seeds)}
    last = {"truth": content["truth"]} if "truth" in content else {}
    before = {key: value for key, value in content.items() if key not in last}
    report.write_json({**before, **made, **last}, json, force=force)


def files_of(model: Model | None, recordings: Sequence[Recording | Log] = ()) -> list[Path]:
    """Return all files that model and recordings were read from, each once."""
    from workbench.recordings import source_files

    read = [] if model is None else model.files
    read = [*read, *(f for r in recordings if r.source for f in source_files(r.source))]
    return list(dict.fromkeys(read))
