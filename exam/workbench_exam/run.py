"""A solver through many cases, an answer's file each; cases that are answered are not asked again."""

from __future__ import annotations

import importlib.util
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from .answers import Answer, from_json, to_json
from .cases import Case
from .reading import read_json


def solver_of(file: Path) -> Callable[[Case], Answer]:
    """The function `solve` of a Python file.

    Raises:
        ValueError: it has none, or does not load, and why.
    """
    spec = importlib.util.spec_from_file_location(f"solver_{file.stem}", file)
    if not file.is_file() or spec is None or spec.loader is None:
        raise ValueError(f"{file}: no such Python file")
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(file.parent))  # a solver may have files beside it
    sys.modules[spec.name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise ValueError(f"{file}: does not load: {_one_line(error)}") from error
    if not callable(getattr(module, "solve", None)):
        raise ValueError(f"{file}: has no function solve(case)")
    return module.solve


def answer_all(solver: Path, cases: Sequence[Case], out: Path) -> list[str]:
    """Names of the cases in which a solver failed; it is asked for each case that has no answer in `out` yet.

    Where it fails the answer is that it sees nothing, and the file says why it failed; it is asked again next
    time.
    """
    solve = solver_of(solver)
    out.mkdir(parents=True, exist_ok=True)
    failures = []
    for number, case in enumerate(cases, 1):
        file = out / f"{case.name}.json"
        if file.exists() and "failed" not in read_json(file):
            continue
        start, worked, failed = time.perf_counter(), _processor(), {}
        try:
            answer = solve(case)
            if not isinstance(answer, Answer):
                raise TypeError(f"solve returned {type(answer).__name__}, not Answer")
            from_json(to_json(answer), "answer", case.drives)
        except Exception as error:  # what a solver's author has to see, and the table counts
            answer, failed = Answer("consistent"), {"failed": _one_line(error)}
            failures.append(case.name)
        spent = {
            "seconds": round(time.perf_counter() - start, 3),
            "processor_seconds": round(_processor() - worked, 3),
        }
        half = file.with_suffix(".part")
        half.write_text(json.dumps(to_json(answer) | spent | failed, indent=1) + "\n", "utf-8")
        half.replace(file)
        names = ", ".join(f"{n.effect}@{n.place}" for n in answer.named)
        said = failed.get("failed", answer.verdict)
        print(f"{number:3d}/{len(cases)} {case.name}: {said} {names}", flush=True)
    return failures


def _processor() -> float:
    """Processor time [s] of this process and of those it started and waited for (on Windows of this one)."""
    return sum(os.times()[:4])


def _one_line(error: Exception) -> str:
    said = " ".join(str(error).split())
    if isinstance(error, ModuleNotFoundError):
        said += "; what the baselines need: pip install './exam[plants,baselines]'"
    return f"{type(error).__name__}: {said}"
