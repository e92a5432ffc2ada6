"""The tables of tasks in the documentation are the tasks in the code."""

import subprocess
import sys
from pathlib import Path

from workbench.training import TASKS

DOCS = Path(__file__).resolve().parents[2] / "docs"


def test_the_tables_are_current() -> None:
    check = [sys.executable, str(DOCS / "write_training.py"), "--check"]
    done = subprocess.run(check, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    text = (DOCS / "training.md").read_text()
    assert all(f"`{term.name}`" in text for task in TASKS.values() for term in task.rewards)
