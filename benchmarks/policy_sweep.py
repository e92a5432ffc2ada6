"""What each threshold of the diagnosis changes: every field of `Policy` a fifth less and a fifth more.

python benchmarks/policy_sweep.py --out sweep.jsonl --quick --jobs 2    # goes on where it stopped
python benchmarks/policy_sweep.py --out sweep.jsonl --first 10 --seed 41 --fields tie,explained

Each case is asked once with all fields *watched* (`watching.py`): what would have been decided otherwise with
another value. It is asked again only with those values, as no other can change its answer; `--again 0`: not.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple

from exam.against import changes
from exam.cases import Case, all_cases
from exam.compact import compact, read
from exam.mark import mark, revision
from exam.oracle import QUICK, oracle_cases
from joblib import Parallel, delayed
from watching import watching

from workbench.diagnosis.policy import POLICY, Policy, trial

SHARE = 0.2
ANSWERS = ("worse", "better", "other")  # what a change of an answer may be; the rest is work
MAY_CHANGE = ("flips", "escapes")  # of `watched.Notes`


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
    parser.add_argument("--again", type=int, help="ask no more than so many cases again")
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
    sweep(chosen, names, arguments.out, arguments.jobs, arguments.patience, arguments.again)
    cases = {case.name for case in chosen}
    print(table([line for line in read(arguments.out) if line["case"] in cases], names))


def sweep(
    cases: Sequence[Case],
    names: Sequence[str],
    out: Path,
    jobs: int,
    patience: float,
    most: int | None = None,
) -> None:
    """Asks each case as it is, then again where another value may change it; writes each line at once.

    Every value is tried in the shortest case first that it may change, then every value in the next.
    """
    done = {(line["case"], *_change(line)): line for line in (read(out) if out.exists() else [])}
    plain = [(case, Change()) for case in cases if (case.name, *Change()) not in done]
    for line in _asked(plain, out, jobs, patience):
        done[line["case"], *_change(line)] = line
        print(f"{line['case']}: {len(_may_change(line))} values may change it", flush=True)
    turn: Counter[Change] = Counter()
    work: list[tuple[int, Case, Change]] = []
    for case in sorted(cases, key=lambda c: done[c.name, *Change()].get("cpu_s", float("inf"))):
        for change in _may_change(done[case.name, *Change()]):
            turn[change] += 1
            if (case.name, *change) not in done and change.field in names:
                work.append((turn[change], case, change))
    work = sorted(work, key=lambda w: w[0])[:most]
    for number, line in enumerate(_asked([w[1:] for w in work], out, jobs, patience), 1):
        print(f"{number}/{len(work)} {line['field']} = {line['value']:g}, {line['case']}", flush=True)


def _may_change(line: dict[str, Any]) -> list[Change]:
    """The values that may change the answer of a case that was asked as it is."""
    return sorted({Change(field, value) for how in MAY_CHANGE for field, value, _ in line[how]})


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
    """The short line of a case's marks with a changed field; of none, with what is noted of all."""
    if change.field is not None:
        with trial(**{change.field: change.value}):
            return {**compact(mark(case, {}, now, patience=patience)), **change._asdict()}
    with watching(values) as notes:
        line = compact(mark(case, {}, now, patience=patience))
    told: dict[str, Any] = {
        how: [[*key, at] for key, at in sorted(getattr(notes, how).items())] for how in MAY_CHANGE
    }
    told["one_way"] = sorted(name for name, came in notes.outcomes.items() if len(came) == 1)
    return {**line, **change._asdict(), "read": sorted(notes.read), **told}


def values(name: str) -> tuple[float, float]:
    """A fifth less and a fifth more of a field; of whole numbers one at least."""
    own = getattr(POLICY, name)
    step = max(1, round(SHARE * own)) if isinstance(own, int) else SHARE * own
    return own - step, own + step


def table(lines: Sequence[dict[str, Any]], names: Sequence[str]) -> str:
    """A row a field that may change answers, those that changed most first; what changed; other fields."""
    before = [line for line in lines if line["field"] is None]
    rows = [row for name in names if (row := _Row.of(name, before, lines)).may_change]
    rows.sort(key=lambda row: (-len(row.found), -row.weight))
    idle = [name for name in names if name not in {row.name for row in rows}]
    read_by = set().union(*(line["read"] for line in before))
    told = [line for line in before if "one_way" in line]
    same = [
        name
        for name in idle
        if (own := [line for line in told if name in line["read"]])
        and all(name in line["one_way"] for line in own)
    ]
    return "\n".join(
        [
            "| field | read | decides, -/+ | may decide, -/+ | asked again, -/+ | answers | work, -/+ |",
            "|---|---|---|---|---|---|---|",
            *(row.text for row in rows),
            "",
            *(f"- {c}" for row in rows for c in row.found),
            *([""] if any(row.found for row in rows) else []),
            f"Decide nothing in {len(before)} cases: {', '.join(n for n in idle if n in read_by) or 'none'}.",
            "",
            f"Of these, compared, and always with the same outcome ({len(told)} cases): "
            f"{', '.join(same) or 'none'}.",
            "",
            f"Never read there: {', '.join(n for n in idle if n not in read_by) or 'none'}.",
        ]
    )


class _Row(NamedTuple):
    """What one field does: cases by its two values, and the answers that changed, in words."""

    name: str
    read: int
    decides: tuple[int, int]
    escapes: tuple[int, int]
    asked: tuple[int, int]
    work: tuple[str, str]
    found: list[str]
    hows: Counter[str]

    @staticmethod
    def of(name: str, before: Sequence[dict[str, Any]], lines: Sequence[dict[str, Any]]) -> _Row:
        """From the lines of cases as they are, and of all."""
        decides, escapes, asked, work = [], [], [], []
        found: list[str] = []
        hows: Counter[str] = Counter()
        for value in values(name):
            flips = {line["case"] for line in before if [name, value] in [f[:2] for f in line["flips"]]}
            left = {line["case"] for line in before if [name, value] in [f[:2] for f in line["escapes"]]}
            after = [line for line in lines if _change(line) == (name, value)]
            changed = [c for c in changes(before, after) if c.how in ANSWERS]
            found += [f"{name} {value:g}, {c.case}, {c.how}: {c.words}" for c in changed]
            hows.update(c.how for c in changed)
            decides.append(len(flips))
            escapes.append(len(left - flips))
            asked.append(len(after))
            work.append(_work(before, after))
        read = sum(name in line["read"] for line in before)
        return _Row(name, read, *map(tuple, (decides, escapes, asked, work)), found, hows)  # type: ignore[arg-type]

    @property
    def weight(self) -> int:
        """In how many cases it decides, either way."""
        return sum(self.decides)

    @property
    def may_change(self) -> bool:
        """Whether it can change any answer."""
        return any((*self.decides, *self.escapes))

    @property
    def text(self) -> str:
        """Its row."""
        counts = ", ".join(f"{self.hows[how]} {how}" for how in ANSWERS if self.hows[how])
        answers = counts or ("same" if any(self.asked) else "")
        cells = (f"{low}/{high}" for low, high in (self.decides, self.escapes, self.asked))
        work = "/".join(self.work) if any(self.work) else ""
        return f"| {self.name} | {self.read} | {' | '.join(cells)} | {answers} | {work} |"


def _work(before: Sequence[dict[str, Any]], after: Sequence[dict[str, Any]]) -> str:
    """How many times the work is done in cases asked again."""
    plain = {line["case"]: line.get("work") or 0.0 for line in before}
    was = sum(plain[line["case"]] for line in after)
    return f"{sum(line.get('work') or 0.0 for line in after) / was:.2f}" if was else ""


def _change(line: dict[str, Any]) -> Change:
    return Change(line["field"], line["value"])


if __name__ == "__main__":
    main()
