"""The page in a real browser: a diagnosis, a click, and the error falls."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from http.client import HTTPConnection
from pathlib import Path
from time import sleep
from urllib.request import urlopen

import pytest

from tests.report.browser import CHROMIUM
from workbench import load_model

from .chrome import Chrome

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs chromium to open the page in")


@pytest.fixture(scope="module")
def server(leg_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Path]]:
    """The command itself, in a folder of its own, and its address."""
    folder = tmp_path_factory.mktemp("served")
    names = [str(leg_folder / f"{n}.toml") for n in ("slow", "validation")]
    command = [
        sys.executable,
        "-m",
        "workbench.cli",
        "ui",
        "leg",
        *names,
        "--no-browser",
        "--holdout",
        names[1],
    ]
    process = subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, bufsize=1
    )
    assert process.stdout and process.stderr
    said = process.stdout.readline()
    address = re.search(r"http://127\.0\.0\.1:\d+/", said)
    assert address, said + process.stderr.read()
    yield address[0], folder
    process.send_signal(signal.SIGINT)
    _, complaints = process.communicate(timeout=30)
    assert process.returncode == 130
    assert complaints.strip() == "", complaints


@pytest.fixture(scope="module")
def chrome(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chrome]:
    with Chrome(tmp_path_factory.mktemp("profile")) as chrome:
        yield chrome


_NAMELESS = """every('input:not([type=hidden]), select, .noUi-handle')
  .filter((e) => !e.ariaLabel && ![...(e.labels ?? [])].some((l) => l.textContent.trim()))
  .map((e) => e.outerHTML)"""


def error(chrome: Chrome) -> float:
    return float(chrome.ask("deep('dd.error').textContent"))


def test_an_effect_is_added_with_a_click_and_the_error_falls(
    server: tuple[str, Path], chrome: Chrome
) -> None:
    address, folder = server
    chrome.look(1280, 900)
    chrome.open(address)
    chrome.wait("document.documentElement.dataset.ready === 'yes'")
    chrome.wait("words().includes('times the noise floor of')")
    before = error(chrome)
    # a diagnosis that is stopped leaves nothing behind; another one may follow
    chrome.ask("button('Find what is missing').click()")
    chrome.wait("words().includes('simulating the model')")
    chrome.ask("button('Stop').click()")
    chrome.wait("button('Find what is missing').offsetParent && !deep('progress')")
    chrome.ask("button('Find what is missing').click()")
    chrome.wait("button('Add Coulomb friction on the knee drive')", 120)
    assert "Something is missing: Coulomb friction on the knee drive" in chrome.ask("words()")
    assert re.search("\\d\u00a0% probable", chrome.ask("deep('h3 .quiet').textContent"))
    chrome.ask("button('Add Coulomb friction on the knee drive').click()")
    chrome.wait("words().includes('explains the data to the noise')")
    after = error(chrome)
    assert after < 0.5 * before
    assert float(chrome.ask("deep('dd.given').textContent")) == before

    # what was found is missing no more
    said = chrome.ask("words()")
    assert "The effects that were found are in the model now." in said and "Something is missing" not in said
    # a slider that is dragged has curves in sight that move
    chrome.wait("deep('.noUi-handle')")
    chrome.ask("window.scrollTo(0, 0)")
    handle, plots = (
        chrome.ask(f"{e}.getBoundingClientRect().top")
        for e in ("deep('.noUi-handle')", "document.getElementById('plots')")
    )
    assert 0 < handle < plots < handle + 200 and plots < 600

    # whatever can be moved or ticked has a name, and a slider says its number to the digits that matter
    chrome.wait("deep('.noUi-handle')?.ariaLabel")
    assert chrome.ask(_NAMELESS) == []
    assert "[N m]" in chrome.ask("deep('.noUi-handle').ariaLabel")
    shown = "Math.abs(1 - Number(deep('.noUi-handle').ariaValueNow) / deep('.bk-spin-wrapper input').value)"
    assert chrome.ask(shown) < 1e-3

    # the key of the responses names what is drawn
    chrome.ask("button('Estimate the responses').click()")
    chrome.wait("words().includes('lines.')")
    keys = "every('.key').map((e) => words(e)).at(-1)"
    chrome.wait(f"{keys} === 'measured model as given with the changes'")
    chrome.ask("every('input[type=checkbox]').find((e) => e.ariaLabel?.startsWith('Closed chain')).click()")
    chrome.wait(f"{keys}.includes('Kin-Only')")

    # a slider moves the error, undo takes it back
    chrome.ask("(() => { const e = deep('.noUi-handle'); e.focus(); return true; })()")
    chrome.key("PageUp", 33)  # one move: of several, as many are steps of their own as a busy machine sees
    chrome.wait(f"Number(deep('dd.error').textContent) > {after}")
    chrome.ask("button('Undo').click()")
    chrome.wait(f"Number(deep('dd.error').textContent) <= {after}")

    chrome.ask("button('Save the model').click()")
    chrome.wait("words().includes('Saved the model')")
    assert load_model(folder / "better.toml").effects[-1].key.effect == "coulomb_friction"
    chrome.ask("button('Save the model').click()")
    chrome.wait("words().includes('the file exists')")
    chrome.ask("button('Save the report').click()")
    chrome.wait("words().includes('Saved the page of the diagnosis')")
    assert "workbench diagnose leg" in (folder / "report.html").read_text()

    # another tab shows the same, and so does this one after loading it again
    chrome.open(address)
    chrome.wait("words().includes('explains the data to the noise')")
    assert error(chrome) == after and chrome.ask("!!button('Remove Coulomb friction')")
    assert chrome.errors == []
    assert all(r.startswith((address, "data:", "blob:")) for r in chrome.requests)


def test_the_motion_plays_and_moves_the_time_in_the_curves(server: tuple[str, Path], chrome: Chrome) -> None:
    chrome.look(390, 800, dark=True)
    chrome.open(server[0])
    chrome.wait(
        "document.documentElement.dataset.ready === 'yes' && document.getElementById('moment').max > 2"
    )
    assert chrome.ask("document.documentElement.scrollWidth") <= 390
    pixels = "document.getElementById('stage').toDataURL()"
    first = chrome.ask(pixels)
    chrome.ask("document.getElementById('play').click()")
    chrome.wait("parseFloat(document.getElementById('clock').textContent) > 0.1")
    chrome.ask("document.getElementById('play').click()")
    assert chrome.ask(pixels) != first
    cursor = "Bokeh.documents[0].get_model_by_name('cursor').data.x[0]"
    assert chrome.ask(cursor) == pytest.approx(
        chrome.ask("parseFloat(document.getElementById('clock').textContent)"), abs=1e-3
    )
    chrome.ask("(document.getElementById('stage').focus(), true)")
    still = chrome.ask(pixels)
    chrome.key("ArrowLeft", 37)
    assert chrome.ask(pixels) != still
    chrome.ask("document.querySelector('[data-zoom=in]').click()")
    chrome.wait("document.getElementById('window').textContent === '0.75 to 2.25 s'")
    assert chrome.errors == []


#: Width and height of what can be tapped and is smaller than a fingertip [px]; the small arrows of a number
#: field are not all that moves it.
_SMALL = """every('button:not(.bk-spin-btn), select, label:has(input), summary')
  .filter((e) => e.getClientRects().length).map((e) => e.getBoundingClientRect())
  .map((r) => [Math.round(r.width), Math.round(r.height)]).filter(([w, h]) => w < 44 || h < 44)"""
#: Where a time and a row of the map are in the window, which is scrolled there.
_CELL = """(() => {
  const models = [...Bokeh.documents[0]._all_models.values()];
  const map = models.find((m) => m.type === 'Figure' && m.y_range.type === 'FactorRange');
  const view = Bokeh.index.find_one(map);
  view.el.scrollIntoView({ block: 'center' });
  const box = view.el.getBoundingClientRect();
  return [box.left + view.frame.x_scale.compute(TIME), box.top + view.frame.y_scale.compute('ROW')];
})()"""


def test_a_finger_on_the_map_looks_at_that_axis_and_time(server: tuple[str, Path], chrome: Chrome) -> None:
    chrome.look(390, 800, dark=True)
    chrome.send("Emulation.setTouchEmulationEnabled", enabled=True)
    chrome.send(
        "Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}]
    )
    chrome.open(server[0])
    chrome.wait("document.documentElement.dataset.ready === 'yes' && words().includes('the noise')")
    chrome.wait(
        "[...Bokeh.documents[0]._all_models.values()].some((m) => m.factors?.includes('hip torque'))", 90
    )
    assert chrome.ask(_SMALL) == []
    shown = "[...every('select')].map((s) => s.selectedOptions[0]?.textContent)"
    for time, row, window in (
        (2.2, "hip torque", "2.10 to 2.30 s"),
        (0.01, "knee position", "0.00 to 0.20 s"),
    ):
        sleep(1.5)  # the page may still be scrolling to what was asked for before
        x, y = chrome.ask(_CELL.replace("TIME", str(time)).replace("ROW", row))
        chrome.tap(x, y)
        chrome.wait(f"document.getElementById('window').textContent === '{window}'")
        axis = row.split()[0]
        chrome.wait(f"{shown}.includes('{axis}')")
        # what was asked for is in sight, below the strip of numbers
        top = "document.getElementById('plots').getBoundingClientRect().top"
        chrome.wait(f"{top} >= deep('.strip').getBoundingClientRect().bottom - 1 && {top} < 600")
    chrome.send("Emulation.setTouchEmulationEnabled", enabled=False)
    assert chrome.errors == []


def test_strangers_are_not_let_in(server: tuple[str, Path]) -> None:
    address = server[0]
    page = urlopen(address).read().decode()
    assert "default-src 'self'" in page and not re.search(r"(src|href)=\"https?://(?!127)", page)
    asked = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13"}
    asked |= {"Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Origin": "http://elsewhere.invalid"}
    connection = HTTPConnection(address.removeprefix("http://").rstrip("/"), timeout=20)
    connection.request("GET", "/ws", headers=asked)
    assert connection.getresponse().status == 403
    connection.close()


@pytest.mark.parametrize("host", ["elsewhere.invalid", "127.0.0.1", "127.0.0.1.elsewhere.invalid:{port}", ""])
@pytest.mark.parametrize("path", ["/", "/ws", "/autoload.js", "/static/js/bokeh.min.js"])
def test_names_that_strangers_point_here_are_not_answered(
    server: tuple[str, Path], host: str, path: str
) -> None:
    own = server[0].removeprefix("http://").rstrip("/")
    connection = HTTPConnection(own, timeout=20)
    connection.request("GET", path, headers={"Host": host.format(port=own.rpartition(":")[2])})
    answer = connection.getresponse()
    assert answer.status in (400, 403) and b"token" not in answer.read()
    connection.close()


def test_the_map_is_as_tall_as_its_rows(server: tuple[str, Path], chrome: Chrome) -> None:
    """It is drawn before its rows are known: two axes with a row of positions and one of torques each."""
    chrome.look(1280, 900)
    chrome.open(server[0])
    chrome.wait("document.documentElement.dataset.ready === 'yes'")
    chrome.wait(f"every('.bk-Figure').some((e) => e.offsetHeight === {64 + 4 * 26})", 30)
