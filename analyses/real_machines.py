"""Every measured machine on one page: what is known of it, what was said, and the error before and after.

    python analyses/real_machines.py DATA_FOLDER                       # all, some minutes
    python analyses/real_machines.py DATA_FOLDER --machine emps ur10e  # these anew, the others as they were
    python analyses/real_machines.py --redraw -o docs                  # page and pictures from the answers

The output folder gets real-machines.json (the answers), real-machines.md (the page) and images/. Answers that
stand there already are kept for machines that are not asked for. The improved models are in the folder of
--runs. What the data are: docs/measured-data.md.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import machine_page
import machine_picture
from machine_table import Answer, Machine, counts, machines, ratio, rows

from workbench.core import InputError
from workbench.core.files import write_whole
from workbench.report import save_figure, write_json

ANSWERS = "real-machines.json"
_RUN = Path(__file__).with_name("machine_run.py")
_DIGITS = 6  # of a number in the answers


def main(arguments: list[str] | None = None) -> None:
    """Ask, and write answers, page and pictures."""
    known = [m["name"] for m in machines()]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=Path, nargs="?", help="folder of the measured data")
    parser.add_argument(
        "--machine", nargs="+", choices=known, default=known, metavar="NAME", help=", ".join(known)
    )
    parser.add_argument("--limit", type=float, default=600.0, help="seconds a machine may take")
    parser.add_argument("--redraw", action="store_true", help="ask nothing anew")
    parser.add_argument(
        "--runs", type=Path, default=Path("out/machines/runs"), help="for recordings and improved models"
    )
    parser.add_argument("-o", "--output", type=Path, default=Path("out/machines"))
    given = parser.parse_args(arguments)
    if not given.redraw and not (given.data and given.data.is_dir()):
        parser.error("name the folder of the measured data (docs/measured-data.md), or --redraw")
    answers = read(given.output / ANSWERS)
    for name in () if given.redraw else given.machine:
        answers[name] = asked(name, given.data, given.runs / name, given.limit)
        print(_line(name, answers[name]), flush=True)
        _write_answers(given.output, answers)
    write_whole(given.output / machine_page.PAGE.name, machine_page.page(answers), force=True)
    for file, figure in machine_picture.figures(answers).items():
        save_figure(figure, given.output / "images" / file, force=True)


def read(file: Path) -> dict[str, Answer]:
    """The answers in a file by machine; none where there is no file."""
    if not file.is_file():
        return {}
    return {a["machine"]: a for a in json.loads(file.read_text(encoding="utf-8"))["answers"]}


def asked(name: str, data: Path, folder: Path, limit: float) -> Answer:
    """One machine's answer, from a process of its own; why there is none under ``failed``."""
    command = [sys.executable, str(_RUN), str(data), name, "--folder", str(folder)]
    child = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    try:
        said, trouble = child.communicate(timeout=limit)
    except subprocess.TimeoutExpired:
        os.killpg(child.pid, signal.SIGKILL)
        child.communicate()
        return {"machine": name, "failed": f"no answer within {limit:g} s"}
    if child.returncode:
        last = trouble.strip().splitlines()[-1:] or [f"exit code {child.returncode}"]
        return {"machine": name, "failed": last[0]}
    return _rounded(json.loads(said))


def marks(machine: Machine, answer: Answer) -> dict[str, float]:
    """How an answer stands beside what is right: see `counts`, `right` causes in all, and `ratio`."""
    errors = {when: ratio(answer, when) for when in ("before", "after")}
    return {**counts(rows(machine, answer)), "right": len(machine.get("right", ())), **errors}


def _line(name: str, answer: Answer) -> str:
    if "failed" in answer:
        return f"{name}: no answer: {answer['failed']}"
    machine = next(m for m in machines() if m["name"] == name)
    n, causes = counts(rows(machine, answer)), len(machine.get("right", ()))
    before, after = (ratio(answer, when) for when in ("before", "after"))
    return (
        f"{name}: {answer['verdict']}, {n['named']} of {causes} named, {n['outside']} outside, "
        f"{n['false']} false; error over noise {before:.3g} to {after:.3g}; {answer['seconds']:.0f} s"
    )


def _write_answers(folder: Path, answers: dict[str, Answer]) -> None:
    known = machines()
    kept = [
        {**answers[m["name"]], "marks": marks(m, answers[m["name"]])} for m in known if m["name"] in answers
    ]
    write_json({"format": 1, "answers": kept}, folder / ANSWERS, force=True)


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: _rounded(v) for k, v in value.items()}
    if isinstance(value, list):
        return [_rounded(v) for v in value]
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value


if __name__ == "__main__":
    try:
        main()
    except InputError as error:
        sys.exit(f"error: {error}")
