"""The catalogue in the documentation is the catalogue in the code."""

import subprocess
import sys
from pathlib import Path

from workbench.effects import EFFECTS

DOCS = Path(__file__).resolve().parents[2] / "docs"


def test_the_catalogue_is_current() -> None:
    check = [sys.executable, str(DOCS / "write_effects.py"), "--check"]
    done = subprocess.run(check, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    index = (DOCS / "effects.md").read_text()
    for effect in EFFECTS:
        assert f"(effects/{effect.name}.md)" in index
        page = (DOCS / "effects" / f"{effect.name}.md").read_text()
        assert page.startswith(f"# {effect.name}\n") and f"workbench add MODEL.toml {effect.name}" in page
