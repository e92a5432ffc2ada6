"""Make cases, ask a solver, score its answers.

workbench-exam make cases                      # the open set: 60 cases of seed 0
workbench-exam run baselines/nothing.py cases  # answers in answers/nothing
workbench-exam score cases answers/*           # a table, and marks.json beside the answers of each
workbench-exam table exam/open-marks.jsonl     # the table of marks that `score --lines FILE` kept; --first 24
workbench-exam reveal cases --key KEY          # truth.json into each case, after answers are in
workbench-exam hashes cases                    # to compare with exam/open.sha256
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import shutil
import sys
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

from .answers import Answer, read_answer
from .cases import read_case
from .reading import read_json
from .run import answer_all
from .scoring import mark
from .seal import OPEN_KEY, truth_of
from .table import lines_of, read_lines, table
from .twins import one_body

Judge = Callable[[Mapping[str, Any], Answer], dict[str, float]]


def main() -> None:
    """Reads arguments and does it; a wrong file ends in one line and exit code 2."""
    parser = argparse.ArgumentParser(
        "workbench-exam", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    does = parser.add_subparsers(dest="what", required=True)
    make = does.add_parser("make", help="draw cases and record them")
    make.add_argument("folder", type=Path)
    make.add_argument("--count", type=_counted, default=60, help="any beginning is a fair sample of kinds")
    make.add_argument("--seed", type=int, default=0, help="of the set; keep it to yourself to set an exam")
    make.add_argument("--key", default=OPEN_KEY, help="seals the truths; likewise")
    make.add_argument("--jobs", type=_counted, default=os.cpu_count())
    run = does.add_parser("run", help="ask a solver: a Python file with `solve(case) -> Answer`")
    run.add_argument("solver", type=Path)
    run.add_argument("cases", type=Path)
    run.add_argument("-o", "--out", type=Path, help="default: answers/NAME")
    run.add_argument("--first", type=_counted, help="only so many cases")
    score = does.add_parser("score", help="mark answers")
    score.add_argument("cases", type=Path)
    score.add_argument("answers", type=Path, nargs="+", help="one folder per solver")
    score.add_argument("--key", default=OPEN_KEY)
    score.add_argument("--first", type=_counted, help="only answers to so many cases")
    score.add_argument(
        "--lines", type=Path, help="also all marks into this file, one line per solver and case"
    )
    kept = does.add_parser("table", help="the table of such a file, without cases or answers")
    kept.add_argument("lines", type=Path)
    kept.add_argument("--first", type=_counted, help="only so many cases of each solver")
    reveal = does.add_parser("reveal", help="write the truth into each case's folder, and check its seal")
    reveal.add_argument("cases", type=Path)
    reveal.add_argument("--key", default=OPEN_KEY)
    hashes = does.add_parser("hashes", help="SHA-256 of each case, to hold against those of another machine")
    hashes.add_argument("cases", type=Path)
    arguments = parser.parse_args()
    try:
        does_it = {"make": _make, "run": _run, "score": _score, "table": _table, "reveal": _reveal}
        (does_it | {"hashes": _hashes})[arguments.what](arguments)
    except (ValueError, ArithmeticError, OSError, ImportError) as error:
        print(" ".join(str(error).split()), file=sys.stderr)
        sys.exit(2)


def _counted(text: str) -> int:
    if int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text}: at least 1")
    return int(text)


def cases_in(folder: Path) -> list[Path]:
    """Folders of cases, in order.

    Raises:
        FileNotFoundError: there is none.
    """
    found = sorted(file.parent for file in folder.glob("*/case.json"))
    if not found:
        raise FileNotFoundError(f"{folder}: no cases; make them: workbench-exam make {folder}")
    return found


def hash_of(folder: Path) -> str:
    """SHA-256 over the files of a case."""
    whole = hashlib.sha256()
    for file in sorted(folder.iterdir()):
        if file.name != "truth.json":
            whole.update(file.name.encode() + b"\0" + file.read_bytes())
    return whole.hexdigest()


def _write(count: int, seed: int, number: int, folder: Path, key: str) -> str:
    from .plants.draw import own_seed, plan
    from .plants.write import make, write

    if (folder / "sealed.json").exists():
        kind, own = plan(count)[number]
        told = truth_of(folder, key)
        if (told["kind"], told["seed"]) != (kind, own_seed(seed, kind, own)):
            raise ValueError(f"{folder}: a case of another seed or count; make this set in a new folder")
        return folder.name
    half = folder.parent / ".part" / folder.name  # its name seals it
    shutil.rmtree(half, ignore_errors=True)
    write(make(count, seed, number), half, key)
    half.replace(folder)
    return folder.name


def _make(a: argparse.Namespace) -> None:
    try:
        from .plants import write  # noqa: F401
    except ImportError as error:
        raise ImportError("making cases needs numba: pip install './exam[plants]'") from error
    folders = [a.folder / f"case-{number:03d}" for number in range(a.count)]
    _write(a.count, a.seed, 0, folders[0], a.key)  # compiles the plant once, for all processes
    with ProcessPoolExecutor(a.jobs) as pool:
        done = [
            pool.submit(_write, a.count, a.seed, number, folder, a.key)
            for number, folder in enumerate(folders)
        ]
        for number, each in enumerate(done, 1):
            print(f"{number:3d}/{a.count} {each.result()}", flush=True)
    shutil.rmtree(a.folder / ".part", ignore_errors=True)


def _run(a: argparse.Namespace) -> None:
    out = a.out or Path("answers") / a.solver.stem
    cases = [read_case(folder) for folder in cases_in(a.cases)[: a.first]]
    failures = answer_all(a.solver, cases, out)
    if failures:
        raise ValueError(
            f"{a.solver}: failed in {len(failures)} of {len(cases)} cases, first in {failures[0]}; these "
            "count as 'consistent' until it is run again, which asks for these alone"
        )


def _score(a: argparse.Namespace) -> None:
    try:
        from .plants.removed import judge
    except ImportError:
        judge = None
        print("without numba (pip install './exam[plants]') error removed is not measured", file=sys.stderr)
    solvers = {answers.name: _marks(a, answers, judge) for answers in a.answers}
    if a.lines:
        a.lines.write_text(lines_of(solvers), "utf-8")
    print(table(solvers))


def _table(a: argparse.Namespace) -> None:
    print(table({solver: marks[: a.first] for solver, marks in read_lines(a.lines).items()}))


def _marks(a: argparse.Namespace, answers: Path, judge: Judge | None) -> list[dict[str, Any]]:
    """Marks of one solver, also written to `marks.json` beside its answers."""
    marks = []
    for file in sorted(answers.glob("case-*.json"))[: a.first]:
        folder = a.cases / file.stem
        if not (folder / "sealed.json").exists():
            raise FileNotFoundError(f"{file}: no case {folder}; name the folder of its cases")
        told = truth_of(folder, a.key)
        drives = read_json(folder / "case.json")["drives"]
        told["one_body"] = one_body(folder / "model.xml", drives)
        answer, seconds = read_answer(file, drives)
        said = read_json(file)
        more = {key: said[key] for key in ("processor_seconds", "failed") if key in said}
        judged = judge(told, answer) if judge else None
        marks.append({"case": file.stem, **mark(told, answer, seconds, judged), **more})
    if not marks:
        raise FileNotFoundError(f"{answers}: no answers; ask a solver: workbench-exam run SOLVER {a.cases}")
    (answers / "marks.json").write_text(json.dumps(marks, indent=1) + "\n", "utf-8")
    return marks


def _reveal(a: argparse.Namespace) -> None:
    for folder in cases_in(a.cases):
        text = json.dumps(truth_of(folder, a.key), indent=1)
        (folder / "truth.json").write_text(text + "\n", "utf-8")


def _hashes(a: argparse.Namespace) -> None:
    for folder in cases_in(a.cases):
        print(f"{hash_of(folder)}  {folder.name}")


if __name__ == "__main__":
    main()
