"""Files that CONTRIBUTING.md points to are there."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_files_that_are_named_exist() -> None:
    rows = [x for x in (ROOT / "CONTRIBUTING.md").read_text().splitlines() if x.startswith(("| a ", "| an "))]
    named = {name for row in rows for name in re.findall(r"`((?:\w+/)*\w+\.py)`", row)}
    assert len(named) > 12
    folders = [ROOT, ROOT / "workbench", *(ROOT / "tests" / x for x in ("recordings", "diagnosis"))]
    assert not [name for name in named if not any((folder / name).is_file() for folder in folders)]
