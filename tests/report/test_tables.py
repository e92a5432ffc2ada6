from __future__ import annotations

import io
import re
from dataclasses import replace

import pytest
from rich.console import Console

from workbench.core import EffectKey, Estimate
from workbench.report import (
    compare_table,
    diagnosis_table,
    improvement_table,
    print_table,
    render_page,
    truth_table,
)
from workbench.report.truth import truth_rows

from . import build


def printed(renderable, width=80, **kwargs) -> str:
    console = Console(file=io.StringIO(), width=width, highlight=False, **kwargs)
    print_table(renderable, console)
    return console.file.getvalue()  # type: ignore[attr-defined]


@pytest.fixture(params=["compare", "diagnose", "improve", "truth"])
def table(request, comparison, diagnosis, improvement):
    return {
        "compare": compare_table(comparison),
        "diagnose": diagnosis_table(diagnosis),
        "improve": improvement_table(improvement),
        "truth": truth_table(improvement, build.TRUTH),
    }[request.param]


def test_it_fits_80_columns_and_is_plain_text(table):
    text = printed(table)
    assert max(len(line) for line in text.splitlines()) <= 80
    assert "\x1b" not in text and "…" not in text


def test_no_color_leaves_no_colour_on_a_terminal(table):
    text = printed(table, force_terminal=True, no_color=True)
    assert "\x1b[3" not in text and ";3" not in text


def test_compare_says_what_and_where(comparison):
    text = printed(compare_table(comparison))
    assert text.startswith("The model does not explain the data")
    assert " mrad" in text and "64 %" in text and "−0.5 to 0.5 rad/s" in text


def test_diagnose_names_the_effect_interval_and_lookalike(diagnosis):
    text = " ".join(printed(diagnosis_table(diagnosis)).split())
    assert "Something is missing: Coulomb friction on the knee drive, 0.254 ± 0.003 N m (95 %)." in text
    assert "97 % probable" in text and "Coulomb friction at the knee joint" in text
    assert "0.201 -> 0.0312" in text and "Measure next: Move the knee slowly" in text


def test_a_number_that_was_not_fitted_has_no_interval(diagnosis):
    (finding, *rest) = diagnosis.findings
    name = next(iter(finding.parameters))
    fixed = replace(finding, parameters={name: Estimate(0.0, 0.0, "kg*m")})
    text = printed(diagnosis_table(replace(diagnosis, findings=(fixed, *rest))))
    assert "0 kg m" in text and "0 kg m  (95 %)" not in text


def test_a_held_out_error_stands_beside_its_own_noise_floor(diagnosis):
    text = printed(diagnosis_table(replace(diagnosis, holdout_noise_error=0.0303)))
    assert "0.201 -> 0.0312  (noise floor 0.0303)" in text
    bare = printed(diagnosis_table(replace(diagnosis, holdout_noise_error=None)))
    assert "0.201 -> 0.0312" in bare and "(noise floor" not in bare


def test_improve_lists_every_step_and_the_noise_floor(improvement):
    text = printed(improvement_table(improvement))
    assert "removed: no longer needed" in " ".join(text.split())
    assert "+ Coulomb friction" in text and "+ Torque gain" in text
    floor = next(line for line in text.splitlines() if line.startswith("Noise floor"))
    assert "0.0303" in floor, "held-out recordings have a floor of their own"


def test_truth_tells_found_from_lookalike_and_missed(improvement):
    hidden = [*build.TRUTH, {"effect": "backlash", "axis": "hip", "parameters": {"gap": 0.01}}]
    step = replace(improvement.steps[1], indistinguishable_from=(EffectKey("backlash", "hip"),))
    text = " ".join(printed(truth_table(replace(improvement, steps=(step,)), hidden), width=160).split())
    assert "not found" in text and "named as a look-alike of torque gain on the hip drive" in text
    assert "0.931 ± 0.008 yes" in text


def test_a_pin_and_a_drive_are_two_places(improvement):
    knee = {"effect": "coulomb_friction", "axis": "knee", "parameters": {"torque": 0.255}}
    (drive,) = truth_rows(improvement, [{**knee, "location": "actuator"}])
    assert (drive.outcome, drive.inside) == ("found", "yes")
    (pin,) = truth_rows(improvement, [{**knee, "location": "joint"}])
    assert (pin.outcome, pin.found) == ("named as a look-alike of Coulomb friction on the knee drive", "")
    alone = replace(improvement.steps[0], indistinguishable_from=())
    (pin,) = truth_rows(replace(improvement, steps=(alone,)), [{**knee, "location": "joint"}])
    assert pin.outcome == "not found"


def test_names_of_strangers_are_printed_as_they_are(comparison):
    entry = comparison.recordings[0]
    bad = replace(entry, recording=replace(entry.recording, name="[red]\x1b[31mx"))
    text = printed(compare_table(replace(comparison, recordings=(bad,))), force_terminal=True)
    assert "[red]" in text and "\x1b[31mx" not in text


def test_a_rig_without_torque_shows_a_dash(without_torque):
    assert "–" in printed(compare_table(without_torque))


def test_an_improvement_of_nothing_says_what_the_rest_goes_with(improvement, diagnosis):
    line = "nearest, but not enough to be named: a brake"
    beside = replace(diagnosis, evidence=(line,))
    nothing = replace(improvement, steps=(), verdict="unexplained", diagnosis=beside)
    assert line[1:] in " ".join(printed(improvement_table(nothing)).split())
    found = replace(improvement, diagnosis=beside)
    assert "nearest" not in printed(improvement_table(found)), "beside a finding stands its own evidence"


def test_what_is_only_nearest_is_not_called_a_cause(improvement, diagnosis):
    line = "the rest goes with time"
    beside = replace(diagnosis, evidence=(line,))
    near = replace(improvement, verdict="unexplained", nearest=True, diagnosis=beside)
    text = " ".join(printed(improvement_table(near)).split())
    assert "No effect that was tried explains what is missing." in text
    assert "With the closest effects, Coulomb friction" in text
    assert line[1:] in text


def test_an_improvement_that_stops_above_noise_says_why(improvement):
    """The verdict says by how much, and said no more."""
    after = build.comparison(0.1)
    assert after.where
    short = replace(improvement, verdict="unexplained", after=after)
    text = " ".join(printed(improvement_table(short)).split())
    assert re.search(
        r"Nothing that was tried explains the rest, of which \d+ % is in the (hip|knee) \w+,", text
    )
    assert "was tried" not in printed(improvement_table(improvement))
    spent = replace(short, diagnosis=replace(short.diagnosis, stopped="budget"))
    text = " ".join(printed(improvement_table(spent)).split())
    assert "The search ended before it had tried everything for the rest" in text
    nothing = replace(short, steps=(), before=after)
    text = " ".join(printed(improvement_table(nothing)).split())
    assert "no effect that was tried explains what is missing" in text
    assert "Of the squared error above the noise, " in text


def test_an_improvement_says_how_sure_its_names_are(improvement):
    assert "97 % probable" in printed(improvement_table(improvement))
    assert "probable" not in printed(improvement_table(replace(improvement, diagnosis=None)))


def test_an_improvement_says_what_a_corrected_number_is_in_all(improvement, diagnosis):
    """What an effect adds to the model's own number read as if it were that number."""
    key = improvement.steps[0].key
    corrects = replace(
        diagnosis.findings[0], key=key, model_value=0.15, total=Estimate(0.4504, 0.0011, "N*m")
    )
    better = replace(improvement, diagnosis=replace(diagnosis, findings=(corrects,)))
    said = "total 0.4504 ± 0.0022 N m, where the model has 0.150"
    assert said in " ".join(printed(improvement_table(better)).split())
    assert said[1:] in " ".join(render_page(better, command="").split())
    assert "in all" not in printed(improvement_table(improvement))
