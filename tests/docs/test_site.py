"""The site builds without a warning, holds every page, and asks nothing of the network."""

from __future__ import annotations

import html
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.report.browser import CHROMIUM
from tests.ui.chrome import Chrome
from workbench.effects import EFFECTS

from .test_commands import PAGES, blocks

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("mkdocs")
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    # no proxy leads anywhere: a page that needs the network cannot be built
    dead = dict.fromkeys(("http_proxy", "https_proxy", "HTTP_PROXY", "HTTPS_PROXY"), "http://127.0.0.1:9")
    environment = {**os.environ, **dead, "NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def test_every_page_is_there(site: Path) -> None:
    pages = {p.relative_to(ROOT / "docs").with_suffix(".html") for p in (ROOT / "docs").rglob("*.md")}
    assert pages and all((site / page).is_file() for page in pages)
    python = (site / "api.html").read_text()
    for function in ("comparison.compare.compare", "diagnosis.improve.improve", "proposing.write.write"):
        assert f'id="workbench.{function}"' in python
    assert "Sums" not in python, "modules stand there in place of functions"


def test_every_block_is_a_block_under_the_name_of_its_file(site: Path) -> None:
    for page in site.rglob("*.html"):
        assert "```" not in page.read_text(), f"{page.name}: a block stands there as text"
    named = [(p, b) for p in PAGES for b in blocks(p) if b[1]]
    for page, (_, name, text) in named:
        built = (site / page.relative_to(ROOT / "docs").with_suffix(".html")).read_text()
        block = re.search(
            rf'class="filename">{re.escape(name or "")}</span>(<pre>.*?)</pre>', built, re.DOTALL
        )
        assert block, f"{page.name}: {name}"
        assert text.split() == html.unescape(re.sub("<[^>]*>", "", block[1])).split(), name
    assert len(named) >= 5


#: Names in tables that stand on more than one line.
_BROKEN = """[...document.querySelectorAll('td code')].filter((e) => e.getClientRects().length > 1)
  .map((e) => e.textContent)"""
_FOOT = "document.querySelector('footer')"


@pytest.mark.skipif(CHROMIUM is None, reason="needs chromium to open the page in")
def test_names_in_tables_and_the_list_of_pages_are_whole(site: Path, tmp_path: Path) -> None:
    with Chrome(tmp_path) as chrome:
        for width, height in ((1280, 900), (390, 844)):
            chrome.look(width, height)
            for page in ("effects", "recordings", "measured-data"):
                chrome.open((site / f"{page}.html").as_uri())
                chrome.wait(f"location.pathname.endsWith('{page}.html') && document.querySelector('td code')")
                assert chrome.ask(_BROKEN) == [], (page, width)
                assert chrome.ask("document.documentElement.scrollWidth") <= width
        chrome.look(1280, 900)
        chrome.open((site / "index.html").as_uri())
        chrome.wait(f"location.pathname.endsWith('index.html') && {_FOOT}")
        assert chrome.ask(f"{_FOOT}.getBoundingClientRect().top") >= 900, "it would cover the list of pages"


def test_mermaid_blocks_are_drawings_in_the_colours_of_the_page(site: Path) -> None:
    pages = [p for p in (ROOT / "docs").rglob("*.md") if "```mermaid" in p.read_text()]
    assert pages
    for page in pages:
        built = (site / page.relative_to(ROOT / "docs").with_suffix(".html")).read_text()
        drawings = re.findall(r'<div class="diagram"><svg.*?</svg></div>', built, re.DOTALL)
        assert len(drawings) == page.read_text().count("```mermaid") and "flowchart TD" not in built
        for svg in drawings:
            assert "var(--md-default-fg-color)" in svg and "<foreignObject" not in svg
    used = {svg for page in site.rglob("*.html") for svg in re.findall(r'<svg id="(d\w+)"', page.read_text())}
    assert used == {p.stem for p in (ROOT / "docs/images/diagrams").iterdir()}, "a drawing of no block"


def test_nothing_is_fetched(site: Path) -> None:
    loads = re.compile(
        r"""<(?:script|img|iframe)[^>]+src=["'](https?:)?//|<link[^>]+href=["'](https?:)?//[^>]+stylesheet"""
    )
    for page in site.rglob("*.html"):
        assert not loads.search(page.read_text()), page
    for sheet in site.rglob("*.css"):
        assert not re.search(r"url\(['\"]?(https?:)?//", sheet.read_text()), sheet


def test_every_effect_has_its_picture() -> None:
    folder = ROOT / "docs" / "images" / "effects"
    assert {p.stem for p in folder.glob("*.png")} == {effect.name for effect in EFFECTS}
    assert sum(p.stat().st_size for p in folder.iterdir()) < 1.5e6


_COPY = "[...document.querySelectorAll('[data-copy]')].map((e) => e.dataset.copy)"


@pytest.mark.skipif(CHROMIUM is None, reason="needs chromium to open the page in")
def test_from_disk_copy_takes_commands_and_nothing_complains(site: Path, tmp_path: Path) -> None:
    with Chrome(tmp_path) as chrome:
        for page in ("tutorial", "index", "effects", "effects/coulomb_friction"):
            chrome.open((site / f"{page}.html").as_uri())
            chrome.wait(f"location.pathname.endsWith('{page}.html') && document.readyState === 'complete'")
            assert chrome.ask("!!document.querySelector('[data-md-component=search]')") is False
            if page == "tutorial":
                copied = chrome.ask(_COPY)
        assert chrome.errors == []
    assert copied and all(line.startswith("workbench ") for text in copied for line in text.splitlines())
    assert "workbench compare better.toml check.toml" in "\n".join(copied)
