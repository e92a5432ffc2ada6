"""Mermaid blocks on the site: the drawing that `docs/draw_diagrams.py` made of each stands in its place.

Git hosts draw such a block; the site, opened from disk, would have to fetch what draws it.
"""

from __future__ import annotations

import hashlib
import re
from pathlib import Path
from typing import Any

from mkdocs.exceptions import PluginError

FOLDER = Path(__file__).with_name("images") / "diagrams"
_BLOCK = re.compile(r"^```mermaid\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(markdown: str) -> list[str]:
    """Texts of the mermaid blocks of a page, in order."""
    return _BLOCK.findall(markdown)


def drawing(text: str) -> Path:
    """File of the drawing of a block; its name is a hash of the text, so that it is never of an older one."""
    return FOLDER / f"d{hashlib.sha256(text.encode()).hexdigest()[:12]}.svg"


def on_page_markdown(markdown: str, **others: Any) -> str:
    """A page with drawings in place of its mermaid blocks; MkDocs calls this for every page."""
    return _BLOCK.sub(_drawn, markdown)


def _drawn(block: re.Match[str]) -> str:
    file = drawing(block[1])
    if not file.is_file():
        raise PluginError(f"no drawing of a mermaid block: run python docs/draw_diagrams.py\n{block[1]}")
    # on one line: an empty line would end the HTML and begin a paragraph
    return f'<div class="diagram">{" ".join(file.read_text().split())}</div>'
