"""Make cases, ask a solver, score its answers.

workbench-exam make cases                              # the open set: 60 cases of seed 0
workbench-exam run baselines/nothing.py cases          # answers in answers/nothing
workbench-exam score cases answers/*                   # a table, and marks.json beside each one's
answers workbench-exam reveal cases --key KEY                  # truth.json into each case, after
answers are in
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

from .answers import read_answer
from .cases import read_case
from .run import answer_all
from .scoring import mark
from .seal import OPEN_KEY, truth_of
from .table import table


def main() -> None:
    """Reads arguments and does it; a wrong file ends in one line and exit code 2."""
    parser = argparse.ArgumentParser(
        "workbench-exam", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    does = parser.add_subparsers(dest="what", required=True)
    make = does.add_parser("make", help="draw cases and record them")
    make.add_argument("folder", type=Path)
    make.add_argument("--count", type=int, default=60, help="any beginning is a fair sample of kinds")
    make.add_argument("--seed", type=int, default=0, help="of the set; keep it to yourself to set an exam")
    make.add_argument("--key", default=OPEN_KEY, help="seals the truths; likewise")
    make.add_argument("--jobs", type=int, default=os.cpu_count())
    run = does.add_parser("run", help="ask a solver: a Python file with `solve(case) -> Answer`")
    run.add_argument("solver", type=Path)
    run.add_argument("cases", type=Path)
    run.add_argument("-o", "--out", type=Path, help="default: answers/NAME")
    run.add_argument("--first", type=int, help="only so many cases")
    score = does.add_parser("score", help="mark answers")
    score.add_argument("cases", type=Path)
    score.add_argument("answers", type=Path, nargs="+", help="a folder a solver")
    score.add_argument("--key", default=OPEN_KEY)
    score.add_argument("--first", type=int, help="only answers to so many cases")
    reveal = does.add_parser("reveal", help="write the truth into each case's folder, and check its seal")
    reveal.add_argument("cases", type=Path)
    reveal.add_argument("--key", default=OPEN_KEY)
    hashes = does.add_parser("hashes", help="SHA-256 of each case, to hold against those of another machine")
    hashes.add_argument("cases", type=Path)
    arguments = parser.parse_args()
    try:
        {"make": _make, "run": _run, "score": _score, "reveal": _reveal, "hashes": _hashes}[arguments.what](
            arguments
        )
    except (ValueError, FileNotFoundError, FileExistsError, ImportError) as error:
        print(error, file=sys.stderr)
        sys.exit(2)


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
    from .plants.write import make, write

    if not (folder / "sealed.json").exists():
        write(make(count, seed, number), folder, key)
    return folder.name


def _make(a: argparse.Namespace) -> None:
    folders = [a.folder / f"case-{number:03d}" for number in range(a.count)]
    _write(a.count, a.seed, 0, folders[0], a.key)  # compiles the plant once, for all processes
    with ProcessPoolExecutor(a.jobs) as pool:
        done = [
            pool.submit(_write, a.count, a.seed, number, folder, a.key)
            for number, folder in enumerate(folders)
        ]
        for number, each in enumerate(done, 1):
            print(f"{number:3d}/{a.count} {each.result()}", flush=True)


def _run(a: argparse.Namespace) -> None:
    out = a.out or Path("answers") / a.solver.stem
    answer_all(a.solver, [read_case(folder) for folder in cases_in(a.cases)[: a.first]], out)


def _score(a: argparse.Namespace) -> None:
    try:
        from .plants.removed import judge
    except ImportError:  # without numba nothing is simulated
        judge = None
    solvers: dict[str, Any] = {}
    for answers in a.answers:
        marks = []
        for file in sorted(answers.glob("case-*.json"))[: a.first]:
            told = truth_of(a.cases / file.stem, a.key)
            known = json.loads((a.cases / file.stem / "case.json").read_text("utf-8"))
            told["first_drive"] = known["drives"][0]
            answer, seconds = read_answer(file)
            said = json.loads(file.read_text("utf-8"))
            judged = judge(told, answer) if judge else None
            failed = {"failed": said["failed"]} if said.get("failed") else {}
            marks.append({"case": file.stem, **mark(told, answer, seconds, judged), **failed})
        if not marks:
            raise FileNotFoundError(f"{answers}: no answers")
        (answers / "marks.json").write_text(json.dumps(marks, indent=1) + "\n", "utf-8")
        solvers[answers.name] = marks
    print(table(solvers))


def _reveal(a: argparse.Namespace) -> None:
    for folder in cases_in(a.cases):
        text = json.dumps(truth_of(folder, a.key), indent=1)
        (folder / "truth.json").write_text(text + "\n", "utf-8")


def _hashes(a: argparse.Namespace) -> None:
    for folder in cases_in(a.cases):
        print(f"{hash_of(folder)}  {folder.name}")


if __name__ == "__main__":
    main()
