"""What tests ask of pages: their tags and words, and a browser that opens them from disk."""

from __future__ import annotations

import shutil
import subprocess
from html.parser import HTMLParser

NASTY = '</script><img src="http://x.invalid/a" onerror="console.error(1)">{{ 7*7 }}<b>'
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


class Page(HTMLParser):
    """What the tests ask of a page: tags, their attributes, and the text outside scripts and styles."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.inside = ""
        self.feed(text)
        self.text = " ".join(" ".join(self.words).split())

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        self.inside = tag

    def handle_endtag(self, tag):
        self.inside = ""

    def handle_data(self, data):
        if self.inside not in ("script", "style"):
            self.words.append(data)


def chromium(page, profile, *more: str) -> tuple[str, str]:
    quiet = (
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--no-first-run",
    )
    done = subprocess.run(
        [
            str(CHROMIUM),
            *("--headless", "--no-sandbox", "--disable-gpu", *quiet, f"--user-data-dir={profile}"),
            *("--enable-logging=stderr", "--virtual-time-budget=20000", *more, "--dump-dom", page.as_uri()),
        ],
        capture_output=True,
        text=True,
        timeout=90,
    )
    return done.stdout, "\n".join(line for line in done.stderr.splitlines() if "CONSOLE" in line)
