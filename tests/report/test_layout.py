"""Pages fit the window: names, paths and numbers of ordinary length, on a telephone and on paper too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from tests.ui.chrome import Chrome
from workbench.core import Comparison, Share
from workbench.report import Sheet, write_page, write_sheet
from workbench.report.sheet import Section, SheetTable

from . import build
from .browser import CHROMIUM

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs chromium to open the page in")

_PAPER = (700, 1040)  # px: A4 less its margins, upright and across
#: Share tables that do not fit the place they have.
_CUT = """[...document.querySelectorAll('.shares')].filter((t) =>
  [t, ...t.querySelectorAll('td, td span')].some((e) =>
    e.getBoundingClientRect().right > t.parentElement.getBoundingClientRect().right + 1)).length"""
_LINES = """Math.max(...[...document.querySelectorAll('.inputs code')].map((e) =>
  e.getBoundingClientRect().height / parseFloat(getComputedStyle(e).lineHeight)))"""


@pytest.fixture(scope="module")
def chrome(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chrome]:
    with Chrome(tmp_path_factory.mktemp("profile")) as chrome:
        yield chrome


def long_names(name: str) -> Comparison:
    """Shares whose axis, range and unit take room."""
    found = build.comparison(0.0)
    shares = tuple(
        Share(name, ("torque_measured", "position")[i % 2], what, (-1.234, -0.567), unit, 0.17 + 0.1 * i)
        for what, unit in (("speed", "rad/s"), ("position", "rad"), ("frequency", "Hz"), ("time", "s"))
        for i in range(3)
    )
    return replace(found, where=shares)


@pytest.fixture
def page(tmp_path: Path) -> Path:
    """A page of inputs with long paths, in a folder's depth and in a file's name."""
    folder = tmp_path / "leg_examples_of_a_long_campaign" / "clean_and_without_any_payload"
    folder.mkdir(parents=True)
    files = [folder / f"multisine_{i}_of_the_sum_and_the_difference.toml" for i in range(3)]
    for file in files:
        file.write_text("format = 1")
    name = "wrist_flex"
    return write_page(long_names(name), tmp_path / "page.html", command="workbench compare", inputs=files)


@pytest.mark.parametrize("width", [1280, 1000, 800, 390])
def test_long_paths_and_names_fit_the_window(page: Path, chrome: Chrome, width: int) -> None:
    chrome.look(width, 900)
    chrome.open(page.as_uri())
    chrome.wait("document.documentElement.dataset.drawn === 'yes'")
    assert chrome.ask("document.documentElement.scrollWidth") <= width
    assert chrome.ask(_LINES) < 5
    assert chrome.ask(_CUT) == 0
    assert chrome.errors == []


#: What a line does not end within: options of the command, and a mark of a key with its words.
_SPLIT = """[...document.querySelectorAll('.option, .key > span')].filter((e) =>
  e.getBoundingClientRect().height > 1.5 * parseFloat(getComputedStyle(e.parentElement).lineHeight))
  .map((e) => e.textContent)"""


def test_options_and_marks_stand_whole_on_a_line(tmp_path: Path, chrome: Chrome) -> None:
    command = "workbench improve leg slow.toml --holdout check.toml -o better.toml --html report.html"
    page = write_page(build.improvement(), tmp_path / "page.html", command=command)
    chrome.look(390, 844)
    chrome.open(page.as_uri())
    chrome.wait("document.documentElement.dataset.drawn === 'yes'")
    assert chrome.ask("document.querySelector('pre code').textContent") == command
    assert chrome.ask("document.querySelectorAll('.option').length") == 3
    assert chrome.ask("document.querySelectorAll('.key > .dot').length") == 0, "it may leave its words behind"
    assert chrome.ask(_SPLIT) == []


@pytest.mark.parametrize("width", _PAPER)
def test_no_share_is_cut_on_paper(page: Path, chrome: Chrome, width: int) -> None:
    chrome.look(width, 900)
    chrome.send("Emulation.setEmulatedMedia", media="print")
    chrome.open(page.as_uri())
    chrome.wait("document.documentElement.dataset.drawn === 'yes'")
    assert chrome.ask(_CUT) == 0 and chrome.ask(_LINES) < 5
    chrome.send("Emulation.setEmulatedMedia", media="")


@pytest.mark.parametrize("width", [1280, 390])
def test_names_that_do_not_break_are_broken_where_they_must(
    tmp_path: Path, chrome: Chrome, width: int
) -> None:
    page = write_page(long_names("left_shoulder_pitch_joint"), tmp_path / "page.html", command="c")
    chrome.look(width, 900)
    chrome.open(page.as_uri())
    chrome.wait("document.documentElement.dataset.drawn === 'yes'")
    assert chrome.ask(_CUT) == 0 and chrome.ask("document.documentElement.scrollWidth") <= width


def test_short_cells_stay_whole_and_pictures_have_a_shadow(tmp_path: Path, chrome: Chrome) -> None:
    """A unit that breaks makes every row of a long table twice as tall; a picture may go on out of sight."""
    head = ("number", ">before", ">after", ">± (95 %)", ">identifiable", "unit")
    rows = (("inertia about the middle", "0.01850", "0.01850", "0.0257", "> 99 %", "kg m²"),)
    table = SheetTable("Numbers", head, rows)
    section = Section("numbers", "Numbers", tables=(table,), picture=(Figure(figsize=(8, 1)), "a picture"))
    sheet = Sheet(kind="links", model="arm", sentence="It is so.", tone="consistent", sections=(section,))
    page = write_sheet(sheet, tmp_path / "page.html", command="c", seeds={})
    chrome.look(390, 844)
    chrome.open(page.as_uri())
    chrome.wait("document.querySelector('.sheet tbody th') !== null")
    tall, name = (
        chrome.ask(f"document.querySelector('.sheet tbody {k}').offsetHeight") for k in ("tr", "th")
    )
    line = chrome.ask("parseFloat(getComputedStyle(document.querySelector('.sheet td')).lineHeight)")
    assert max(tall, name) < 1.9 * line, "one line, and the space around it"
    shadow = chrome.ask("getComputedStyle(document.querySelector('.picture')).backgroundImage")
    assert shadow.count("gradient") == 4
