"""Blocks on the site: the name of a file is their title, and commands are copied without what they print.

Blocks name their file as ```` ```toml arm.toml ````.

Git hosts show such a block and pass over its name, and the tests write it to that file. The site's Markdown
does not know it as a block at all.
"""

from __future__ import annotations

import html
import re
from typing import Any

_NAMED = re.compile(r"^```(?P<language>\w+) (?P<file>[\w./-]+)$", re.MULTILINE)


def on_page_markdown(markdown: str, **others: Any) -> str:
    """A page as the site's Markdown writes it; MkDocs calls this for every page."""
    return _NAMED.sub(r'```\g<language> title="\g<file>"', markdown)


_SESSION = re.compile(
    r'<div class="highlight">(?P<code><pre><span></span><code><span class="gp">.*?)</div>', re.DOTALL
)


def on_page_content(content: str, **others: Any) -> str:
    """Each session with the commands that its Copy button copies; MkDocs calls this for every page."""
    return _SESSION.sub(_with_commands, content)


def _with_commands(session: re.Match[str]) -> str:
    text = html.unescape(re.sub(r"<[^>]*>", "", session["code"]))
    commands = html.escape("\n".join(re.findall(r"^\$ (.*)$", text, re.MULTILINE)), quote=True)
    return f'<div class="highlight" data-copy="{commands}">{session["code"]}</div>'
