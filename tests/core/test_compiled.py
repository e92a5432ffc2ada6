"""Machine code that is kept is the code of the files as they are."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from workbench.core import compiled

PACKAGE = Path(compiled.__file__).parents[1]
INNER = "from core.compiled import compiled\n\n@compiled()\ndef inner(x):\n    return {} * x\n"
OUTER = """
from core.compiled import compiled
from effects.inner import inner

@compiled()
def outer(x):
    return inner(x) + 1.0

print(outer(1.0), sum(outer.stats.cache_hits.values()))
"""


def said(folder: Path) -> str:
    run = subprocess.run(
        [sys.executable, "-m", "effects.outer"], cwd=folder, capture_output=True, text=True, check=True
    )
    return run.stdout.strip()


def test_a_caller_notices_that_what_it_calls_has_changed(tmp_path: Path) -> None:
    for name in ("core", "effects", "simulation"):
        (tmp_path / name).mkdir()
    (tmp_path / "core" / "compiled.py").write_text(Path(compiled.__file__).read_text())
    (tmp_path / "effects" / "outer.py").write_text(OUTER)
    (tmp_path / "effects" / "inner.py").write_text(INNER.format(2.0))
    assert [said(tmp_path), said(tmp_path)] == ["3.0 0", "3.0 1"]
    (tmp_path / "effects" / "inner.py").write_text(INNER.format(5.0))
    assert said(tmp_path) == "6.0 0"


def test_whatever_is_compiled_is_in_the_hash() -> None:
    """Every file that uses numba declares its functions in the way and the folders that are looked for."""
    for file in PACKAGE.rglob("*.py"):
        text = file.read_text()
        if file == Path(compiled.__file__) or not re.search(
            r"^(from|import) numba|import compiled\b", text, re.M
        ):
            continue
        assert file.parent.name in ("effects", "simulation"), file
        assert ("compiled(" in text or "@law" in text) and not re.search(r"\bn?jit\(", text), file
