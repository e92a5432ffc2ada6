from __future__ import annotations

import base64
import gzip
import json
import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from workbench.core import Check, InputError, Verification
from workbench.report import Sheet, render_sheet, verification_sheet, write_sheet
from workbench.report.response import response_panel
from workbench.report.sheet import Curve, Drawing, Panel, Row, Section, SheetTable

from .browser import CHROMIUM, NASTY, Page, chromium

COMMAND = "workbench check leg"


def response(lines: int = 300) -> Panel:
    f = np.geomspace(0.2, 60.0, lines)
    s = 2j * np.pi * f
    g = np.exp(-0.003 * s) / (0.0162 * s + 0.0972)
    scatter = 0.02 * np.abs(g).mean()
    draw = np.random.default_rng(0)
    seen = g + scatter * (draw.normal(size=lines) + 1j * draw.normal(size=lines)) / np.sqrt(2)
    half, std = np.full(lines, 2 * scatter), np.full(lines, scatter)
    models = {"closed_chain": g, "kin_only": 1.3 * g}
    return response_panel("hip over hip", "rad/s / (N m)", f, seen, half, std, models)


def sheet(name: str = "leg", panels: int = 2) -> Sheet:
    drawing = Drawing(tuple(response() for _ in range(panels)), f"A caption of {name}.")
    table = SheetTable("Errors", ("Model", ">Error"), ((name, "7 %"), ("kin_only", "30 %")))
    return Sheet(
        kind="frequency responses",
        model=name,
        tone="missing_effect",
        sentence=f"{name} misses.",
        key_numbers=(("Error", "7 %", "of it"),),
        sections=(
            Section("errors", "Errors", (name,), (table,)),
            Section("r", "Response", drawings=(drawing,), remarks=(name,)),
        ),
    )


def verification(failing: bool = False) -> Verification:
    checks = (
        Check("jacobian", 1e-16, 1e-9, "m/rad", "MuJoCo, Drake"),
        Check("mass_matrix", 3e-9 if failing else 5e-11, 1e-9, "", "MuJoCo, Drake", "a mass differs"),
    )
    alpha = np.arange(0.0, 181.0, 15.0)
    variants = {"kin_only": (0.04, 0.002, 0.0185), "exact": (0.07, 0.0237, 0.0237)}
    facts = {"mass": (-0.0407, "kg", "Free base: mass off by")}
    return Verification("leg", checks, variants, alpha, 0.9 - 1e-3 * alpha, facts, ("the foot: none",))


@pytest.mark.parametrize("made", [sheet(), verification_sheet(verification())], ids=["frf", "check"])
def test_it_can_be_read_aloud_and_asks_nothing_of_a_network(made):
    page = Page(render_sheet(made, command=COMMAND, seeds={"postures": 3}))
    tags = [t for t, _ in page.tags]
    assert tags.count("h1") == tags.count("main") == tags.count("header") == 1 and "nav" in tags
    assert tags.count("caption") == tags.count("table")
    assert all(a.get("alt") for t, a in page.tags if t == "img")
    levels = [int(t[1]) for t in tags if re.fullmatch(r"h[1-6]", t)]
    assert all(b <= a + 1 for a, b in pairwise(levels))
    ids = [a["id"] for _, a in page.tags if "id" in a]
    assert len(ids) == len(set(ids))
    assert {a["aria-labelledby"] for _, a in page.tags if "aria-labelledby" in a} <= set(ids)
    for tag, attrs in page.tags:
        assert tag not in ("link", "iframe", "object", "embed", "base")
        for name in ("src", "href"):
            assert re.match(r"(#|data:)", attrs.get(name) or "#"), (tag, attrs)
    assert COMMAND in page.text and "seed of postures 3" in page.text


def test_a_check_says_what_broke_and_what_it_was_allowed():
    good = Page(render_sheet(verification_sheet(verification()), command=COMMAND)).text
    assert "leg: all 2 quantities agree." in good and "FAILS" not in good
    assert "0.04000" in good and "Free base: mass off by −0.0407 kg." in good and "the foot: none" in good
    made = verification_sheet(verification(failing=True))
    bad = Page(render_sheet(made, command=COMMAND)).text
    assert made.tone == "missing_effect" and "mass matrix FAILS 3.0e-09 1e-09" in bad
    assert "mass matrix: a mass differs" in bad


def test_without_anything_to_draw_no_library_is_carried():
    bare = replace(verification(), alpha_deg=np.zeros(0), radius=np.zeros(0))
    page = render_sheet(verification_sheet(bare), command=COMMAND)
    assert len(page) < 50_000 and "<script" not in page


def values(page: str) -> list[dict]:
    packed = re.search(r'id="values">(.*?)</script>', page, re.DOTALL)
    assert packed
    return json.loads(gzip.decompress(base64.b64decode(packed[1])))


def test_the_drawing_holds_magnitude_phase_and_error():
    panel = values(render_sheet(sheet(panels=1), command=COMMAND))[0]
    magnitude, phase, error = panel["rows"]
    f = np.array(magnitude["curves"][1]["x"])
    by_name = {c["name"]: c for c in magnitude["curves"]}
    g = 1 / np.abs(0.0162 * 2j * np.pi * f + 0.0972)
    np.testing.assert_allclose(by_name["closed chain"]["v"], g, rtol=1e-4)
    assert (np.array(by_name["uncertainty"]["low"]) < np.array(by_name["uncertainty"]["high"])).all()
    falls = {c["name"]: c for c in phase["curves"]}["closed chain"]["v"]
    delayed = -np.degrees(np.arctan(0.0162 / 0.0972 * 2 * np.pi * f[-1]) + 0.003 * 2 * np.pi * f[-1])
    assert falls[-1] == pytest.approx(delayed, abs=0.1)  # and no jump by a turn on the way
    off = {c["name"]: c for c in error["curves"]}
    assert np.median(off["Kin-Only"]["v"]) == pytest.approx(30.0, abs=3.0)
    assert "Kin-Only 3" in panel["summary"]


def test_a_phase_that_noise_rules_is_not_drawn():
    f = np.linspace(1.0, 10.0, 40)
    g = np.full(40, 1.0 + 0j)
    half = np.where(f < 5, 0.1, 3.0)
    panel = response_panel("x", "1", f, g, half, half, {"fit": 1.01 * g})
    measured = panel.rows[1].curves[1].y
    assert measured is not None and np.array_equal(np.isnan(measured), f >= 5)


def test_many_lines_are_thinned_and_the_ends_stay():
    f = np.geomspace(0.1, 100.0, 20_000)
    row = Row("y", (Curve("a", "fit", f, f),))
    long = Sheet("check", "m", "consistent", "s", sections=(
        Section("s", "S", drawings=(Drawing((Panel("t", "x", (row,), "words"),), "c"),)),),
    )  # fmt: skip
    x = values(render_sheet(long, command=COMMAND))[0]["rows"][0]["curves"][0]["x"]
    assert len(x) <= 500 and (x[0], x[-1]) == (0.1, 100.0)


def test_it_is_written_whole_or_not_at_all(tmp_path):
    path = write_sheet(sheet(), tmp_path / "page.html", command=COMMAND)
    before = path.read_bytes()
    with pytest.raises(InputError, match="the file exists"):
        write_sheet(sheet(), path, command=COMMAND)
    with pytest.raises(InputError, match="cannot read"):
        write_sheet(sheet(), path, command=COMMAND, inputs=[tmp_path / "gone"], force=True)
    assert path.read_bytes() == before


@pytest.mark.skipif(CHROMIUM is None, reason="needs chromium to open the page in")
def test_a_browser_draws_it_from_disk(tmp_path):
    path = write_sheet(sheet(NASTY, panels=3), tmp_path / "page.html", command=NASTY)
    assert path.stat().st_size < 5e6
    dom, console = chromium(path, tmp_path / "profile")
    assert console == "" and 'data-drawn="yes"' in dom
    parsed = Page(dom)
    drawn = [a for t, a in parsed.tags if "js-plotly-plot" in (a.get("class") or "")]
    assert len(drawn) == 3 and all("closed chain" in (a["aria-label"] or "") for a in drawn)
    assert "hidden" in next(a for _, a in parsed.tags if a.get("id") == "fallback")
    figures = [a for t, a in parsed.tags if t == "figure" and a.get("class") == "drawing"]
    assert figures and all("hidden" not in a for a in figures)
    assert [t for t, _ in parsed.tags].count("img") == 1 and "{{ 7*7 }}" in parsed.text


def test_checks_are_named_in_words():
    made = replace(verification(), checks=(Check("s3n_frf", 0.0, 1e-6, "", "two"),))
    page = Page(render_sheet(verification_sheet(made), command=COMMAND)).text
    assert "S3N frequency response ok" in page
