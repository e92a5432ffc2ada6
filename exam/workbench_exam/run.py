"""A solver through many cases, an answer's file each; cases that are answered are not asked again."""

from __future__ import annotations

import importlib.util
import json
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from .answers import Answer, from_json, to_json
from .cases import Case


def solver_of(file: Path) -> Callable[[Case], Answer]:
    """The function `solve` of a Python file.

    Raises:
        ValueError: it has none.
    """
    spec = importlib.util.spec_from_file_location(f"solver_{file.stem}", file)
    if not file.is_file() or spec is None or spec.loader is None:
        raise ValueError(f"{file}: no such Python file")
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(file.parent))  # a solver may have files beside it
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    if not callable(getattr(module, "solve", None)):
        raise ValueError(f"{file}: has no function solve(case)")
    return module.solve


def answer_all(solver: Path, cases: Sequence[Case], out: Path) -> None:
    """Asks a solver; where it fails the answer is that it sees nothing, and the file says why it failed."""
    solve = solver_of(solver)
    out.mkdir(parents=True, exist_ok=True)
    for number, case in enumerate(cases, 1):
        file = out / f"{case.name}.json"
        if file.exists():
            continue
        start, failed = time.perf_counter(), None
        try:
            answer = solve(case)
            from_json(to_json(answer), case.name)
        except Exception as error:  # what a solver's author has to see, and the table counts
            answer, failed = Answer("consistent"), f"{type(error).__name__}: {error}"
        data = to_json(answer) | {"seconds": round(time.perf_counter() - start, 3)}
        if failed:
            data["failed"] = failed
        half = file.with_suffix(".part")
        half.write_text(json.dumps(data, indent=1) + "\n", "utf-8")
        half.replace(file)
        names = ", ".join(f"{n.effect}@{n.place}" for n in answer.named)
        print(f"{number:3d}/{len(cases)} {case.name}: {failed or answer.verdict} {names}", flush=True)
