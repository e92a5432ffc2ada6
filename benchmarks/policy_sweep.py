"""What each threshold of the diagnosis changes: every field of `Policy` a fifth less and a fifth more.

python benchmarks/policy_sweep.py --out sweep.jsonl --quick --jobs 2    # goes on where it stopped
python benchmarks/policy_sweep.py --out sweep.jsonl --first 10 --seed 41 --fields tie,explained

A case is asked again only for fields that its diagnosis reads as it is: no other can change it. Still it
takes the diagnosis of each case more than a hundred times.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple

from exam.against import changes
from exam.cases import Case, all_cases
from exam.compact import compact, read
from exam.mark import mark, revision
from exam.oracle import QUICK, oracle_cases
from joblib import Parallel, delayed

from workbench.diagnosis.policy import POLICY, Policy, trial

SHARE = 0.2
ANSWERS = ("worse", "better", "other")  # what a change of an answer may be; the rest is work


class Change(NamedTuple):
    """A field with another value; no field where a case is asked as it is."""

    field: str | None = None
    value: float = 0.0


def main() -> None:
    """Asks what is not in the file yet, and prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, required=True, help="one JSON line a case and value")
    parser.add_argument("--seed", type=int, default=0, help="draws another exam")
    parser.add_argument("--first", type=int, help="only so many cases")
    parser.add_argument("--quick", action="store_true", help=f"the first {QUICK} cases of the oracle")
    parser.add_argument("--cases", nargs="*", default=[], help="only cases whose name has one of these in it")
    parser.add_argument("--fields", help="only these, with commas between them")
    parser.add_argument("--jobs", type=int, default=-1)
    parser.add_argument(
        "--patience", type=float, default=900.0, help="a diagnosis that takes longer failed [s]"
    )
    arguments = parser.parse_args()
    known = [field.name for field in fields(Policy)]
    names = arguments.fields.split(",") if arguments.fields else known
    if unknown := set(names) - set(known):
        parser.error(f"no field of Policy: {', '.join(sorted(unknown))}")
    every = oracle_cases()[:QUICK] if arguments.quick else all_cases(arguments.seed)
    wanted = [c for c in every if not arguments.cases or any(part in c.name for part in arguments.cases)]
    chosen = wanted[: arguments.first]
    sweep(chosen, names, arguments.out, arguments.jobs, arguments.patience)
    cases = {case.name for case in chosen}
    print(table([line for line in read(arguments.out) if line["case"] in cases], names))


def sweep(cases: Sequence[Case], names: Sequence[str], out: Path, jobs: int, patience: float) -> None:
    """Asks each case as it is and with either value of each field that it reads; writes each line at once."""
    done = {(line["case"], *_change(line)): line for line in (read(out) if out.exists() else [])}
    plain = [(case, Change()) for case in cases if (case.name, *Change()) not in done]
    for line in _asked(plain, out, jobs, patience):
        done[line["case"], *_change(line)] = line
    tried = [Change(name, value) for name in names for value in values(name)]
    work = [
        (case, change)
        for case in cases
        for change in tried
        if (case.name, *change) not in done and change.field in done[case.name, *Change()]["read"]
    ]
    for number, line in enumerate(_asked(work, out, jobs, patience), 1):
        print(f"{number}/{len(work)} {line['field']} = {line['value']:g}, {line['case']}", flush=True)


def _asked(
    work: Sequence[tuple[Case, Change]], out: Path, jobs: int, patience: float
) -> Iterator[dict[str, Any]]:
    now = revision()
    tasks = (delayed(answer)(case, change, now, patience) for case, change in work)
    lines: Any = Parallel(jobs, return_as="generator_unordered")(tasks)
    for line in lines:
        with out.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
        yield line


def answer(case: Case, change: Change, now: str, patience: float) -> dict[str, Any]:
    """The short line of a case's marks with a changed field, and the fields that were read for it."""
    with trial(**({} if change.field is None else {change.field: change.value})), _noted() as seen:
        line = compact(mark(case, {}, now, patience=patience))
    return {**line, **change._asdict(), "read": sorted(seen)}


def values(name: str) -> tuple[float, float]:
    """A fifth less and a fifth more of a field; of whole numbers one at least."""
    own = getattr(POLICY, name)
    step = max(1, round(SHARE * own)) if isinstance(own, int) else SHARE * own
    return own - step, own + step


def table(lines: Sequence[dict[str, Any]], names: Sequence[str]) -> str:
    """A row a field and value where any of the two changed an answer or the work; then all other fields."""
    before = [line for line in lines if line["field"] is None]
    rows, idle = ["| field | value | answers | work | cases |", "|---|---|---|---|---|"], []
    for name in names:
        after = [[line for line in lines if _change(line) == (name, value)] for value in values(name)]
        both = [_row(name, value, before, own) for value, own in zip(values(name), after, strict=True)]
        if any(both):
            rows += [
                row or f"| {name} | {v:g} | none | 1.00 | |"
                for row, v in zip(both, values(name), strict=True)
            ]
        else:
            idle.append(name)
    read_by = set().union(*(line["read"] for line in before))
    known = f"Changed nothing in {len(before)} cases that read them"
    rows += ["", f"{known}: {', '.join(n for n in idle if n in read_by) or 'none'}."]
    return "\n".join(
        [*rows, f"Never read there: {', '.join(n for n in idle if n not in read_by) or 'none'}."]
    )


def _row(name: str, value: float, before: Sequence[dict[str, Any]], after: Sequence[dict[str, Any]]) -> str:
    """What a value changed, as a row; empty where that is nothing."""
    found = [c for c in changes(before, after) if c.how in ANSWERS]
    work = {line["case"]: line.get("work") or 0.0 for line in before}
    was, now = sum(work[line["case"]] for line in after), sum(line.get("work") or 0.0 for line in after)
    if not found and was == now:
        return ""
    counts = {how: sum(c.how == how for c in found) for how in ANSWERS}
    answers = ", ".join(f"{n} {how}" for how, n in counts.items() if n) or "none"
    words = "; ".join(f"{c.case}: {c.words}" for c in found)
    return f"| {name} | {value:g} | {answers} | {now / max(was, 1.0):.2f} | {words} |"


@contextmanager
def _noted() -> Iterator[set[str]]:
    """The names of fields that are read meanwhile."""
    seen: set[str] = set()

    def get(policy: Policy, name: str) -> Any:
        seen.add(name)
        return object.__getattribute__(policy, name)

    Policy.__getattribute__ = get  # type: ignore[method-assign]
    try:
        yield seen
    finally:
        del Policy.__getattribute__
        seen &= {field.name for field in fields(Policy)}


def _change(line: dict[str, Any]) -> Change:
    return Change(line["field"], line["value"])


if __name__ == "__main__":
    main()
