from __future__ import annotations

import base64
import gzip
import hashlib
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from workbench.core import Comparison, Diagnosis, Improvement, InputError
from workbench.report import render_page, write_page
from workbench.report.pack import plots
from workbench.report.residual_strip import residual_strips

from . import build
from .browser import CHROMIUM, NASTY, Page, chromium

COMMAND = "workbench improve models/leg.toml chirp.toml -o better.toml"


@pytest.fixture(scope="module", params=["compare", "diagnose", "improve", "demo"])
def page(request, comparison, diagnosis, improvement) -> Page:
    result = {"compare": comparison, "diagnose": diagnosis}.get(request.param, improvement)
    truth = build.TRUTH if request.param == "demo" else None
    return Page(render_page(result, command=COMMAND, seeds={"fit": 7}, truth=truth))


@pytest.fixture(scope="module")
def improved(improvement: Improvement) -> str:
    """The page of an improvement; most of its time are its pictures."""
    return render_page(improvement, command=COMMAND)


@pytest.fixture(scope="module")
def diagnosed(diagnosis: Diagnosis) -> str:
    return render_page(diagnosis, command=COMMAND)


@pytest.fixture(scope="module")
def compared(comparison: Comparison) -> str:
    return render_page(comparison, command=COMMAND)


def test_it_asks_nothing_of_a_network(page):
    for tag, attrs in page.tags:
        assert tag not in ("link", "iframe", "object", "embed", "base")
        for name in ("src", "href", "srcset", "data", "action"):
            assert re.match(r"(#|data:)", attrs.get(name) or "#"), (tag, attrs)
    policy = next(a["content"] for t, a in page.tags if a.get("http-equiv") == "Content-Security-Policy")
    assert policy.startswith("default-src 'none'") and "http" not in policy


def test_it_can_be_read_aloud(page):
    tags = [t for t, _ in page.tags]
    assert dict(page.tags)["html"]["lang"] == "en"
    assert tags.count("h1") == tags.count("main") == tags.count("header") == 1 and "nav" in tags
    assert tags.count("caption") == tags.count("table")
    assert all(a.get("alt") for t, a in page.tags if t == "img")
    levels = [int(t[1]) for t in tags if re.fullmatch(r"h[1-6]", t)]
    assert all(b <= a + 1 for a, b in pairwise(levels))
    ids = [a["id"] for _, a in page.tags if "id" in a]
    assert len(ids) == len(set(ids))
    named = [a[k] for _, a in page.tags for k in ("aria-labelledby",) if k in a]
    assert set(named) <= set(ids)


def test_it_says_how_to_reproduce_it(tmp_path, diagnosis):
    source = tmp_path / "chirp.toml"
    source.write_text("format = 1")
    text = Page(render_page(diagnosis, command=COMMAND, seeds={"fit": 7}, inputs=[source])).text
    assert COMMAND in text and hashlib.sha256(b"format = 1").hexdigest() in text
    assert "seed of fit 7" in text and "numpy " + np.__version__ in text
    twice = [source, tmp_path / "." / "chirp.toml", tmp_path / "x" / ".." / "chirp.toml"]
    (tmp_path / "x").mkdir()
    once = Page(render_page(diagnosis, command=COMMAND, inputs=twice)).text
    assert once.count(hashlib.sha256(b"format = 1").hexdigest()) == 1
    with pytest.raises(InputError, match="cannot read"):
        render_page(diagnosis, command=COMMAND, inputs=[tmp_path / "gone.toml"])


def test_it_says_what_is_missing_how_sure_and_what_else(diagnosed):
    text = Page(diagnosed).text.replace("\u00a0", " ")
    assert "Something is missing: Coulomb friction on the knee drive, 0.254 ± 0.003 N m (95 %)." in text
    assert "97 % probable" in text and "cannot tell it from Coulomb friction at the knee joint" in text
    assert "On held-out data the error falls from 0.201 to 0.0312." in text
    assert "Thermal derating on all axes" in text and "friction at the drive and at the joint" in text


def test_an_improvement_says_how_sure_its_names_are(improvement, improved):
    assert "97 % probable" in Page(improved).text
    assert "probable" not in Page(render_page(replace(improvement, diagnosis=None), command=COMMAND)).text


def test_it_shows_the_shape_of_what_no_effect_explains():
    page = Page(render_page(build.unexplained(), command=COMMAND))
    assert "a description, not a cause" in page.text and "hip: position 97 %" in page.text
    assert "knee: a tone of 3.7 Hz 61 %" in page.text and "the position of hip at its median" in page.text
    [words] = [a["alt"] for t, a in page.tags if t == "img" and "Missing torque" in (a["alt"] or "")]
    least_and_most = "least 0 N m at −1 rad, most 1.60 N m at 1 rad, each ± 0.040 N m"
    assert f"Missing torque at hip against position: {least_and_most}." in words
    assert "shape of what no effect" not in Page(render_page(build.diagnosis(), command=COMMAND)).text


def test_held_out_errors_stand_beside_their_own_floor(improvement, improved):
    text = Page(improved).text
    assert "on the held-out recordings that is 0.0303" in text
    bare = replace(improvement, holdout_noise_error=None)
    assert "on the held-out recordings that" not in Page(render_page(bare, command=COMMAND)).text


def test_the_truth_stands_beside_the_answer(improvement):
    text = Page(render_page(improvement, command=COMMAND, truth=build.TRUTH)).text
    assert text.index("The truth beside the answer") < text.index("The error, step by step")
    assert "not found" in text and "0.2550 N m" in text


def test_strangers_strings_stay_strings(comparison):
    entry = comparison.recordings[0]
    recording = replace(entry.recording, name=NASTY, axes=(NASTY, "knee"))
    bad = replace(
        comparison,
        model=NASTY,
        axes=(NASTY, "knee"),
        notes=(NASTY,),
        recordings=(replace(entry, recording=recording),),
    )
    html = render_page(bad, command=NASTY, seeds={NASTY: 1})
    parsed = Page(html)
    assert [t for t, _ in parsed.tags].count("img") == 1 and "{{ 7*7 }}" in parsed.text
    assert [t for t, _ in parsed.tags].count("script") == 4


def test_curves_are_what_was_measured(comparison, improvement):
    values, curves = plots(comparison, improvement.after)
    data = gzip.decompress(base64.b64decode(curves))
    entry = comparison.recordings[0]
    c = values["recordings"][0]["axes"][1]["torque"]["curves"]["measured"]
    planes = np.frombuffer(data, np.uint8)[c["at"] : c["at"] + 4 * c["n"]].reshape(4, -1).astype(np.int64)
    zigzag = sum(planes[k] << (8 * k) for k in range(4))
    decoded = np.cumsum((zigzag >> 1) ^ -(zigzag & 1)) * c["step"]
    truth = entry.recording.signals["torque_measured"][:, 1]
    assert np.abs(decoded - truth).max() < build.NOISE["torque_measured"] / 20
    lost = entry.recording.time[~entry.recording.valid]
    assert values["recordings"][0]["gaps"] == [pytest.approx([6.0, lost[-1]])]


def test_many_recordings_leave_the_worst(comparison):
    many = replace(comparison, recordings=comparison.recordings * 20)
    values, _ = plots(many, None)
    assert values["left_out"] == 40 - len(values["recordings"]) > 0


def test_results_without_comparisons_or_torque_have_pages(diagnosis, improvement, without_torque):
    assert "Something is missing" in render_page(replace(diagnosis, before=None, after=None), command=COMMAND)
    bare = replace(improvement, before=None, after=None, diagnosis=None, steps=(), holdout_error_after=None)
    assert "nothing was added" in render_page(bare, command=COMMAND)
    assert "Measured and simulated" in render_page(without_torque, command=COMMAND)
    assert "<h1" in render_page(replace(without_torque, recordings=()), command=COMMAND)


def test_motion_that_was_not_compared_is_not_drawn_as_a_fit(comparison):
    entries = [replace(e, position_rmse=np.full(2, np.nan)) for e in comparison.recordings]
    values, _ = plots(replace(comparison, recordings=tuple(entries)), None)
    assert all(r["axes"][1]["position"] is None and r["axes"][1]["torque"] for r in values["recordings"])
    assert values["axes"][1]["position"]["against"]["speed"]["before"]["centre"] == []


def test_it_is_written_whole_or_not_at_all(tmp_path, comparison):
    path = write_page(comparison, tmp_path / "page.html", command=COMMAND)
    before = path.read_bytes()
    with pytest.raises(InputError, match="the file exists"):
        write_page(comparison, path, command=COMMAND)
    with pytest.raises(InputError, match="cannot read"):
        write_page(comparison, path, command=COMMAND, inputs=[tmp_path / "gone"], force=True)
    assert path.read_bytes() == before and len(list(tmp_path.iterdir())) == 1


@pytest.mark.skipif(CHROMIUM is None, reason="needs chromium to open the page in")
@pytest.mark.parametrize("what", ["a minute", "nasty"])
def test_a_browser_draws_it_from_disk(tmp_path, what):
    result = build.improvement(60.0, 1000.0) if what == "a minute" else build.improvement()
    shapes = build.unexplained().shapes
    if what == "a minute":
        result = replace(result, diagnosis=replace(result.diagnosis, shapes=shapes))
    if what == "nasty":
        first = replace(result.before, axes=(NASTY, "knee"))  # type: ignore[type-var]
        result = replace(
            first,
            recordings=tuple(
                replace(e, recording=replace(e.recording, name=NASTY, axes=(NASTY, "knee")))
                for e in first.recordings
            ),
        )
    path = write_page(result, tmp_path / "page.html", command=COMMAND)
    assert path.stat().st_size < 5e6
    dom, console = chromium(path, tmp_path / "profile")
    assert console == ""  # the page's policy would complain here of anything asked of a network
    assert 'data-drawn="yes"' in dom
    parsed = Page(dom)
    drawn = [a for t, a in parsed.tags if "js-plotly-plot" in (a.get("class") or "")]
    count = 9 + (len(shapes) if what == "a minute" else 0)
    assert len(drawn) == count and all(a["aria-label"] for a in drawn)
    assert dom.count("js-line") >= count
    pictures = [a for t, a in parsed.tags if a.get("id") == "fallback" or a.get("class") == "fallback"]
    assert all("hidden" in a for a in pictures)
    assert [t for t, _ in parsed.tags].count("img") == len(pictures) == (2 if what == "a minute" else 1)


@pytest.mark.skipif(CHROMIUM is None, reason="needs chromium to open the page in")
def test_zoom_and_choice_work_without_a_mouse(tmp_path, improved):
    page = improved
    script = """<script>
      const by = (id) => document.getElementById(id), seen = [];
      const wait = setInterval(() => {
        if (!document.documentElement.dataset.drawn) return;
        clearInterval(wait);
        const note = () => seen.push(by("window").textContent);
        for (const move of ["all", "in", "right", "out"]) {
          document.querySelector(`[data-zoom=${move}]`).click();
          note();
        }
        by("pick-axis").value = "0";
        by("pick-axis").dispatchEvent(new Event("change"));
        note();
        Plotly.relayout("plot-time", { "xaxis.range": [2, 3] }).then(() => {
          note();
          seen.push(by("plot-time").getAttribute("aria-label").slice(0, 4));
          dispatchEvent(new Event("beforeprint"));
          dispatchEvent(new Event("afterprint"));
          document.title = seen.join("|");
        });
      }, 50);
    </script></body>"""
    path = tmp_path / "page.html"
    path.write_text(page.replace("</body>", script))
    dom, console = chromium(path, tmp_path / "profile")
    assert console == ""
    seen = re.search(r"<title>(.*?)</title>", dom)
    whole = "0 to 12 s of 12 s"
    steps = [whole, "3 to 9 s of 12 s", "6 to 12 s of 12 s", whole, whole, "2 to 3 s of 12 s", "hip "]
    assert seen and seen.group(1).split("|") == steps


@pytest.mark.skipif(CHROMIUM is None, reason="needs chromium to open the page in")
def test_the_policy_stops_requests_and_says_so(tmp_path, compared):
    path = tmp_path / "page.html"
    page = compared
    path.write_text(page.replace("</body>", '<img src="http://localhost:9/a.png"></body>'))
    _, console = chromium(path, tmp_path / "profile")
    assert "Content Security Policy" in console


def test_what_is_only_nearest_is_shown_as_no_cause(improvement, improved):
    near = replace(improvement, verdict="unexplained", nearest=True)
    assert (
        "What was added: the nearest effects, which are not the cause"
        in Page(render_page(near, command=COMMAND)).text
    )
    assert "not a cause" not in Page(improved).text


def test_held_out_recordings_have_their_own_numbers(improved: str, diagnosed: str) -> None:
    shown = Page(improved).text
    assert "The same for the held-out recordings" in shown and "walk, held out" in shown
    assert "held-out recordings, which" not in Page(diagnosed).text


def test_the_residual_comes_first_and_needs_no_script(improvement: Improvement, improved: str) -> None:
    strips = residual_strips(improvement.before, improvement.after)
    assert strips and strips.title == "Residual torque of knee in chirp_knee"
    assert [s.style for s in strips.strips] == ["before", "after"]
    assert all(s.size.endswith(" N m") for s in strips.strips), "sizes that are compared have one unit"
    spread = [np.std([float(y) for y in re.findall(r" ([\d.]+)", s.path)]) for s in strips.strips]
    assert spread[1] < 0.3 * spread[0]
    assert all(s.path.count("M") == 2 for s in strips.strips), "a gap in the recording is a gap in the line"
    page = improved
    assert page.index(strips.strips[1].path) < page.index('id="steps"')
    assert len(residual_strips(improvement.before, None).strips) == 1  # type: ignore[union-attr]
    assert residual_strips(None, None) is None


def test_hashes_are_folded_at_the_end(diagnosis: Diagnosis) -> None:
    page = render_page(diagnosis, command=COMMAND, inputs=[__file__])
    folded = page.index("<details>", page.index('id="reproduce"'))
    assert folded < page.index(hashlib.sha256(Path(__file__).read_bytes()).hexdigest())


def test_a_comparison_says_what_its_error_is(compared) -> None:
    text = Page(compared).text
    assert "divided by the measured signal's standard deviation" in text
    assert "Each table divides the same error differently; do not add them." in text
