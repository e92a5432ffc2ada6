"""An exam for the diagnosis: more than two hundred hidden effects, several at once, none, and unknown ones.

python benchmarks/hidden_effects.py --out marks.jsonl --jobs 2           # goes on where it stopped
python benchmarks/hidden_effects.py --out marks.jsonl --first 60         # a fair sample of all kinds
python benchmarks/hidden_effects.py --out marks.jsonl --cases s0-clean   # those whose name has this in it
python benchmarks/hidden_effects.py --out marks.jsonl --others least_squares sysid  # and other methods
python benchmarks/hidden_effects.py --report marks.jsonl --figures figures

Cases like those of the field, on robots that are no leg with rods (`exam/field/__init__.py`):

python benchmarks/hidden_effects.py --family arm --seed 7 --first 12 --out marks.jsonl \\
    --against benchmarks/field.jsonl    # the first marks of all families

The oracle, which a change of the diagnosis is held against: 120 cases of two simulators, measured machines.

python benchmarks/hidden_effects.py --quick --out marks.jsonl --against benchmarks/oracle.jsonl    # 30 cases
python benchmarks/hidden_effects.py --oracle --out marks.jsonl --against benchmarks/oracle.jsonl   # all
python benchmarks/hidden_effects.py --report marks.jsonl --machines docs/real-machines.json \\
    --write benchmarks/oracle.jsonl    # what is given takes the place of what is there
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

from baselines import METHODS
from exam.against import changes
from exam.against import report as differences
from exam.cases import Case, all_cases
from exam.compact import compact, machine_line
from exam.compact import read as read_compact
from exam.compact import write as write_compact
from exam.field.cases import FAMILIES, field_cases
from exam.figures import draw_all
from exam.mark import mark, revision
from exam.oracle import QUICK, oracle_cases
from exam.table import tables
from joblib import Parallel, delayed


def main() -> None:
    """Runs cases, or reports on those that were run."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--out", type=Path, help="one JSON line a case; cases that are there are not run again"
    )
    parser.add_argument("--seed", type=int, default=0, help="draws another exam")
    parser.add_argument("--family", choices=FAMILIES, help="cases of the field on this robot")
    parser.add_argument("--jobs", type=int, default=-1)
    parser.add_argument("--first", type=int, help="only so many cases; any beginning is a fair sample")
    parser.add_argument("--cases", nargs="*", default=[], help="only cases whose name has one of these in it")
    parser.add_argument("--others", nargs="*", default=[], choices=sorted(METHODS), help="also ask these")
    parser.add_argument(
        "--patience", type=float, default=900.0, help="a diagnosis that takes longer failed [s]"
    )
    parser.add_argument(
        "--again", action="store_true", help="diagnose each improved model too: nothing may be added"
    )
    parser.add_argument("--list", action="store_true", help="name the cases and stop")
    parser.add_argument("--oracle", action="store_true", help="the 120 cases that changes are held against")
    parser.add_argument("--quick", action="store_true", help=f"the first {QUICK} of these")
    parser.add_argument(
        "--against", type=Path, help="short lines; say what is better, worse, other than they"
    )
    parser.add_argument("--write", type=Path, help="short lines of the marks go into this file")
    parser.add_argument(
        "--machines", type=Path, help="answers of analyses/real_machines.py, to compare or write as cases too"
    )
    parser.add_argument("--report", type=Path, nargs="+", help="marks to report on")
    parser.add_argument("--figures", type=Path, help="folder for the report's figures")
    arguments = parser.parse_args()
    if arguments.report:
        lines = read(arguments.report)
        if arguments.against or arguments.write:
            conclude(lines, arguments.machines, arguments.write, arguments.against)
            return
        print(tables(lines))
        if arguments.figures:
            draw_all(lines, arguments.figures)
        return
    if arguments.oracle or arguments.quick:
        cases = oracle_cases()[: QUICK if arguments.quick else None]
    elif arguments.family:
        cases = field_cases(arguments.family, arguments.seed)
    else:
        cases = all_cases(arguments.seed)
    chosen = [
        case for case in cases if not arguments.cases or any(part in case.name for part in arguments.cases)
    ][: arguments.first]
    if arguments.list:
        print("\n".join(case.name for case in chosen))
        return
    if arguments.out is None:
        parser.error("give --out or --report")
    run(chosen, arguments.out, arguments.jobs, arguments.others, arguments.patience, arguments.again)
    names = {case.name for case in chosen}
    lines = [line for line in read([arguments.out]) if line["case"] in names]
    conclude(lines, arguments.machines, arguments.write, arguments.against)


def conclude(
    marks: list[dict[str, Any]], machines: Path | None, to: Path | None, against: Path | None
) -> None:
    """Writes the marks' short lines, and says what changed; exit code 1 where something is worse."""
    lines = [compact(line) for line in marks]
    if machines is not None:
        lines += [machine_line(answer) for answer in json.loads(machines.read_text("utf-8"))["answers"]]
    old = read_compact(against) if against else []
    if to is not None:
        write_compact(lines, [case.name for case in oracle_cases()], to)
    if against:
        print(differences(old, lines))
        sys.exit(any(change.how == "worse" for change in changes(old, lines)))


def run(
    cases: list[Case], out: Path, jobs: int, others: list[str], patience: float, again: bool = False
) -> None:
    """Marks what `out` has not got, cases or others' answers, and writes each as soon as it is there."""
    marks = {line["case"]: line for line in read([out])} if out.exists() else {}
    work = [
        (case, missing) for case in cases if (missing := _missing(marks.get(case.name), others)) is not None
    ]
    now, started = revision(), time.perf_counter()
    tasks = (
        delayed(mark)(
            case, {name: METHODS[name] for name in names}, now, marks.get(case.name), patience, again
        )
        for case, names in work
    )
    with out.open("a") as file:
        file.write("\n")  # where a line was cut off by a stop
        marked: Any = Parallel(jobs, return_as="generator_unordered")(tasks)
        for number, line in enumerate(marked, 1):
            file.write(json.dumps(line) + "\n")
            file.flush()
            left = (time.perf_counter() - started) / number * (len(work) - number) / 60
            print(
                f"{number:4d}/{len(work)} {line['case']:55s} {line.get('outcome') or line['failed']:12s} "
                f"{'; '.join(f['key'] for f in line.get('findings', []))}"
                f"{'; again: ' + ', '.join(line['again']) if line.get('again') else ''}"
                f"  ({left:.0f} min left)",
                flush=True,
            )


def _missing(line: dict[str, Any] | None, others: list[str]) -> list[str] | None:
    """Which other methods are still to be asked; None where nothing is to be done."""
    if line is None:
        return others
    return [name for name in others if name not in line["others"]] or None if "others" in line else None


def read(files: list[Path]) -> list[dict[str, Any]]:
    """The latest marks of each case; a line that was cut off by a stop is left out."""
    lines = {}
    for text in (text for file in files for text in file.read_text().splitlines()):
        try:
            line = json.loads(text)
        except json.JSONDecodeError:
            continue
        lines[line["case"]] = line
    return list(lines.values())


if __name__ == "__main__":
    main()
