"""What a search tried: in JSON, in the page of results, and as a page of its own."""

from __future__ import annotations

import json
import re
from dataclasses import replace

from workbench.core import Diagnosis
from workbench.report import diagnosis_dict, render_page, render_sheet, trace_sheet
from workbench.report.search_sheet import trace_figure

from .browser import Page


def test_json_has_all_that_was_tried_in_order(diagnosis: Diagnosis) -> None:
    first, other = json.loads(json.dumps(diagnosis_dict(diagnosis)["trace"]))
    assert first["taken"] and not other["taken"] and other["why"].startswith("it explains 80 %")
    assert [e["effect"] for e in other["begun_with"]] == ["coulomb_friction"]
    assert [r["effect"] for r in first["added"][0]["rivals"]] == ["coulomb_friction", "viscous_damping"]
    assert first["times_noise"] == [7.1, 1.02] and other["parameters"] == 3


def test_the_page_of_results_has_it_as_a_fold(diagnosis: Diagnosis) -> None:
    page = Page(render_page(diagnosis, command="workbench diagnose"))
    assert (
        "What the search tried" in page.text
        and "2. A gap or soft joint that explains the residual torque" in page.text
    )
    nothing = Page(render_page(replace(diagnosis, trace=()), command="workbench diagnose"))
    assert "What the search tried" not in nothing.text


def test_its_own_page_says_why_and_from_what(diagnosis: Diagnosis) -> None:
    page = Page(render_sheet(trace_sheet(diagnosis), command="workbench diagnose --trace"))
    for words in (
        "1. One effect after the other",
        "it explains the recordings",
        "from Coulomb friction on the knee drive",
        "viscous damping",
        "41 %",
    ):
        assert words in page.text, words
    (picture,) = [a for _, a in page.tags if a.get("class") == "picture"]
    assert "2 models were tried" in (picture["aria-label"] or "")


def test_its_picture_follows_the_colours_of_the_page(diagnosis: Diagnosis) -> None:
    odd = replace(diagnosis, trace=tuple(replace(t, move="<b>one</b>") for t in diagnosis.trace))
    text = render_sheet(trace_sheet(odd), command="workbench diagnose --trace")
    svg = text[text.index("<svg") : text.index("</svg>")]
    assert "stroke: var(--after)" in svg and not re.search(r"#[0-9a-f]{6}[;\"]", svg)
    assert "<style" not in svg and "<b>" not in svg and "&lt;b&gt;one" in svg


def test_where_nothing_was_searched_it_says_so(diagnosis: Diagnosis) -> None:
    right = replace(diagnosis, verdict="consistent", findings=(), trace=())
    page = Page(render_sheet(trace_sheet(right), command="workbench diagnose --trace"))
    assert "Nothing was searched" in page.text


def test_the_picture_has_a_line_for_each_and_the_noise(diagnosis: Diagnosis) -> None:
    (ax,) = trace_figure(diagnosis.trace).axes
    assert [t.get_text() for t in ax.get_yticklabels()] == [
        "1. one effect after the other",
        "2. a gap or soft joint that explains the residual torque",
    ]
    assert "noise" in ax.get_xlabel() and ax.get_xscale() == "log"
    ends = {line.get_xdata()[-1] for line in ax.lines}
    assert {1.02, 3.4, 1.0} <= {float(x) for x in ends}
