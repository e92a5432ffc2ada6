"""Time in the table is work: waiting is none, and that of a process that the solver starts is."""

import json
from pathlib import Path

from workbench_exam.cases import read_case
from workbench_exam.run import answer_all

WAITS = "import time\nfrom workbench_exam.answers import Answer\n"
WAITS += "def solve(case):\n    time.sleep(0.4)\n    return Answer('consistent')\n"
STARTS = "import subprocess, sys\nfrom workbench_exam.answers import Answer\n"
STARTS += "WORK = 'import time\\nwhile time.process_time() < 0.4: pass'\n"
STARTS += (
    "def solve(case):\n    subprocess.run([sys.executable, '-c', WORK])\n    return Answer('consistent')\n"
)


def spent(text: str, case: Path, folder: Path) -> dict:
    (folder / "mine.py").write_text(text)
    answer_all(folder / "mine.py", [read_case(case)], folder / "out")
    return json.loads((folder / "out" / "case-000.json").read_text())


def test_waiting_is_no_work(case: Path, tmp_path: Path) -> None:
    said = spent(WAITS, case, tmp_path)
    assert said["seconds"] >= 0.4 and said["processor_seconds"] < 0.2


def test_work_of_processes_that_a_solver_starts_counts(case: Path, tmp_path: Path) -> None:
    assert spent(STARTS, case, tmp_path)["processor_seconds"] >= 0.35
