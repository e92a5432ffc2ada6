"""Blocks that name their file, as ```` ```toml arm.toml ````, on the site: the name stands as their title.

Git hosts show such a block and pass over its name, and the tests write it to that file. The site's Markdown
does not know it as a block at all.
"""

from __future__ import annotations

import re
from typing import Any

_NAMED = re.compile(r"^```(?P<language>\w+) (?P<file>[\w./-]+)$", re.MULTILINE)


def on_page_markdown(markdown: str, **others: Any) -> str:
    """A page as the site's Markdown writes it; MkDocs calls this for every page."""
    return _NAMED.sub(r'```\g<language> title="\g<file>"', markdown)
