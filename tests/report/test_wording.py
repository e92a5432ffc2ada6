from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from workbench.core import EffectKey, Estimate, Outlier, Share
from workbench.report import diagnosis_dict, render_page, sentence
from workbench.report.answer import mend_sentences, near_sentence
from workbench.report.comparison_words import loop_sentence
from workbench.report.ladder import log_axis, rungs
from workbench.report.numbers import interval, number, percent, quantity, short, unit_text
from workbench.report.wording import effect_phrase, effect_phrases, share_phrase, sized_phrase

from . import build
from .browser import Page


@pytest.mark.parametrize(
    ("value", "std", "unit", "text"),
    [
        (0.2541, 0.0016, "N*m", "0.254 ± 0.003 N m"),
        (-1.5, 0.1, "rad", "−1.50 ± 0.20 rad"),
        (1234.0, 51.0, "", "1230 ± 100"),
        (294073.0, 19758.0, "N/m", "290000 ± 40000 N/m"),
        (2.5e-7, 1e-9, "s", "(2.500 ± 0.020) × 10⁻⁷ s"),
        (-1e-7, 2.5e-6, "kg*m", "(0 ± 5) × 10⁻⁶ kg m"),
        (0.5, float("nan"), "1", "0.5000"),
        (float("nan"), 0.1, "m", "– m"),
    ],
)
def test_interval(value, std, unit, text):
    assert interval(Estimate(value, std, unit)) == text


def test_numbers():
    assert [number(v) for v in (0.0665, -12.3456, 0.0, float("nan"), 1.5e-9)] == [
        "0.0665",
        "−12.3",
        "0",
        "–",
        "1.50 × 10⁻⁹",
    ]
    assert [short(v) for v in (0.5, 2.0, 100.0, -0.25)] == ["0.5", "2", "100", "−0.25"]
    assert [percent(v) for v in (0.001, 0.5, 0.999, 1.0)] == ["< 1 %", "50 %", "> 99 %", "100 %"]
    assert quantity(0.00042, "rad") == "0.420 mrad"
    assert unit_text("N*m/(rad/s)**2") == "N m/(rad/s)²"


def test_effects_have_names_and_places():
    assert effect_phrase(EffectKey("coulomb_friction", "knee")) == "Coulomb friction on the knee drive"
    assert effect_phrase(EffectKey("delay", None)) == "delay on all axes"
    assert effect_phrase(EffectKey("backlash", "hip", "joint")) == "backlash at the hip joint"
    assert effect_phrase(EffectKey("payload_mass", None)) == "payload mass at the end of the machine"
    payload = EffectKey("payload_mass", None, site="tool")
    assert effect_phrase(payload) == "payload mass at site 'tool'" and payload == EffectKey(
        "payload_mass", None
    )
    size = {"mass": Estimate(0.6, 0.002, "kg")}
    assert sized_phrase(payload, size) == "a payload of 0.600 ± 0.004 kg (95 %) at site 'tool'"


def test_verdicts(comparison, diagnosis, improvement):
    at_noise = replace(comparison, consistent=True, error=1.1 * comparison.noise_error)
    assert sentence(at_noise) == "The model explains the data to the noise."
    allowed = sentence(replace(at_noise, error=2.5 * comparison.noise_error))
    assert "its error is 2.5 times the noise floor, and two correct simulations" in allowed
    assert "nothing to compare" in sentence(replace(comparison, error=float("nan")))
    unknown = replace(diagnosis, verdict="unexplained", findings=(), unexplained_fraction=0.73)
    assert (
        sentence(unknown)
        == "Something is missing: no effect that was tried explains what is missing; 73 % of the squared "
        "error above the noise remains."
    )
    at_floor = sentence(replace(unknown, error=unknown.noise_error))
    assert at_floor.startswith("The error as a whole is at the noise floor") and "100 %" not in at_floor
    spent = sentence(replace(unknown, stopped="budget"))
    assert "before it had tried everything" in spent and "no effect" not in spent
    partly = replace(diagnosis, verdict="partly_explained", unexplained_fraction=0.4)
    end = (
        "This is certain, but it is not the whole cause: 40 % of the squared error above the noise "
        "has another cause."
    )
    assert sentence(partly).endswith(end)
    assert "links are wrong too" in sentence(replace(partly, by_links=0.97))
    doubted = tuple(replace(f, probability=0.6) for f in partly.findings)
    assert "certain" not in sentence(replace(partly, findings=doubted)), "a name of 60 % is not"
    two = replace(diagnosis, findings=diagnosis.findings * 2)
    assert sentence(two).startswith("Two effects are missing: Coulomb friction on the knee drive (0.25")
    assert "explains the data to the noise" in sentence(improvement)
    assert "still 3.0 times the noise floor" in sentence(
        replace(improvement, verdict="unexplained", error_after=3 * improvement.noise_error)
    )
    assert "nothing was added" in sentence(replace(improvement, steps=()))
    first, last = improvement.steps
    taken_out = sentence(replace(improvement, steps=(first, replace(last, removed=(first.key,)))))
    assert taken_out.startswith("With torque gain on the hip drive, 0.931 ± 0.008 (95 %), the model explains")
    worst = Outlier("knee", "torque", 1.44, 1.31)
    off = replace(improvement, after=replace(improvement.after, consistent=False, outlier=worst))
    assert "to the noise as a whole (the " in sentence(off)
    assert "noise alone explains at most 1.31): " in sentence(off)
    near = replace(comparison, error=1.01 * comparison.noise_error, outlier=worst)
    assert "the knee torque is off by 1.44 times its own noise; noise alone" in sentence(near)


def test_a_wrong_number_is_told_with_what_it_is_instead(diagnosis):
    """What the model has too much or too little of is not missing."""
    finding = diagnosis.findings[0]
    damping = replace(
        finding,
        key=EffectKey("viscous_damping", "thigh"),
        parameters={"damping": Estimate(-0.32, 0.01, "N*m*s/rad")},
        number="damping",
        model_value=0.6,
        total=Estimate(0.28, 0.01, "N*m*s/rad"),
    )
    one = sentence(replace(diagnosis, findings=(damping,)))
    assert one == (
        "A number of the model is wrong: the damping on the thigh drive is "
        "0.280 ± 0.020 N m s/rad, not 0.600."
    )
    both = sentence(replace(diagnosis, findings=(damping, finding)))
    assert both.startswith(one) and "Something is missing too: Coulomb friction on the knee drive" in both
    moment = replace(
        finding,
        key=EffectKey("first_moment_error", "bend"),
        number="first moment",
        parameters={"along": Estimate(0.09, 0.002, "kg*m"), "across": Estimate(0.0, 0.001, "kg*m")},
    )
    told = sentence(replace(diagnosis, findings=(moment,)))
    assert told.startswith(
        "A number of the model is wrong: the first moment of the bend link differs by 0.09"
    )
    many = sentence(replace(diagnosis, findings=(damping,) * 4))
    assert many.startswith(
        "Four numbers of the model are wrong: damping on the thigh, thigh, thigh and thigh"
    )


def test_one_name_of_several_is_no_fact(diagnosis):
    finding = replace(
        diagnosis.findings[0], probability=0.08, model_value=0.03, total=Estimate(0.031, 1e-4, "")
    )
    alike = replace(finding, indistinguishable_from=tuple(EffectKey("backlash", str(k)) for k in range(3)))
    assert "(or one of three other causes that look the same)" in sentence(
        replace(diagnosis, findings=(alike, alike))
    )
    assert "look the same" not in sentence(replace(diagnosis, findings=(replace(alike, probability=0.6),)))
    delay = replace(
        finding,
        key=EffectKey("command_delay", None),
        indistinguishable_from=tuple(EffectKey("current_loop_lag", axis) for axis in ("hip", "knee")),
    )
    told = sentence(replace(diagnosis, findings=(delay,)))
    assert "(or current loop lag on the hip and knee drives, which looks the same)" in told


def test_of_many_causes_only_those_in_doubt_are_told_one_by_one(diagnosis) -> None:
    sure = [
        replace(diagnosis.findings[0], key=EffectKey("viscous_damping", axis), probability=0.98)
        for axis in ("hip", "knee", "ankle")
    ]
    alike = (EffectKey("link_inertia_error", "hip"),)
    doubted = replace(
        sure[0], key=EffectKey("reflected_inertia", "hip"), probability=0.2, indistinguishable_from=alike
    )
    assert sentence(replace(diagnosis, findings=(sure[0], doubted, *sure[1:]))) == (
        "Four effects are missing: viscous damping on the hip, knee and ankle drives and reflected inertia "
        "on the hip drive (or link inertia error of the hip link, which looks the same)."
    )


def test_shares_say_where():
    share = Share("knee", "torque_measured", "speed", (-1.0, 1.0), "rad/s", 0.64)
    assert share_phrase(share) == "64 % is in the knee torque, at speeds of −1 to 1 rad/s"
    assert "above 2 rad/s" in share_phrase(replace(share, range=(2.0, float("inf"))))


def test_ladder(improvement, comparison):
    steps = rungs(improvement)
    assert [r.error for r in steps] == [improvement.error_before, *(s.error for s in improvement.steps)]
    assert len(rungs(comparison)) == 1
    axis = log_axis([0.01, 0.1, None, float("nan")])
    places = [axis.place(v) for v in (0.01, 0.1)]
    assert 0 < places[0] < places[1] < 1  # type: ignore[operator]
    assert axis.place(0.0) is None and axis.ticks == (0.01, 0.02, 0.05, 0.1)


def test_places_of_one_effect_share_a_phrase() -> None:
    keys = [
        EffectKey("torque_saturation", "hip"),
        EffectKey("command_delay", None),
        EffectKey("torque_saturation", "knee"),
        EffectKey("torque_saturation", "knee", "joint"),
    ]
    assert effect_phrases(keys) == [
        "torque saturation on the hip and knee drives",
        "command delay on all axes",
        "torque saturation at the knee joint",
    ]


def test_a_loop_that_noise_blows_up_is_no_verdict_on_the_data(comparison) -> None:
    lost = replace(comparison, error=304.0, noise_error=345.0, consistent=False)
    assert "cannot run in these loops" in sentence(lost) and "order of the axes" in sentence(lost)


def test_it_is_said_why_no_motion_was_compared():
    known = build.comparison(0.0)
    assert loop_sentence(known) == ""
    entries = [replace(known.recordings[0], position_rmse=np.full(2, np.nan)), known.recordings[1]]
    unknown = replace(known, recordings=tuple(entries))
    said = "The controller of chirp_hip is not known"
    assert loop_sentence(unknown).startswith(said)
    assert said in Page(render_page(unknown, command="workbench compare")).text


def test_harmonics_of_a_ripple_are_one_cause_with_their_number() -> None:
    kin = [EffectKey("cogging", "hip", copy=k) for k in (1, 2, 3)]
    assert effect_phrases([*kin, EffectKey("cogging", "knee")]) == ["cogging on the hip and knee drives"]
    assert effect_phrases(kin) == ["cogging on the hip drive (3 harmonics)"]


def test_gains_that_are_stated_wrongly_are_no_missing_effect(diagnosis) -> None:
    scales = {"kp_scale": Estimate(0.8, 0.005, "1"), "kd_scale": Estimate(1.3, 0.01, "1")}
    key = EffectKey("controller_gain_error", "lift")
    gains = replace(diagnosis.findings[0], key=key, parameters=scales)
    line = "correct run.toml, line 6 ([controller]): kp of lift is 150 and should be 120"
    told = replace(diagnosis, findings=(gains,), mend=(line,))
    assert sentence(told) == (
        "The controller's gains are stated wrongly: on the lift drive kp is 0.800 ± 0.010 and kd is "
        "1.300 ± 0.020 times what is stated."
    )
    page = Page(render_page(told, command="workbench diagnose")).text
    assert f"C{line[1:]}. Correct the file or use the model with the effect, not both" in page
    ours = replace(told, mend_recordings=(key,))
    assert mend_sentences(ours)[1:] == [
        "Correct gains where they are stated; a model does not need an effect for them."
    ]
    assert diagnosis_dict(ours)["mend"] == [line]
    assert diagnosis_dict(ours)["mend_recordings"] == [
        {"effect": key.effect, "axis": "lift", "location": "actuator"}
    ]
    both = sentence(replace(told, findings=(gains, diagnosis.findings[0])))
    assert "Something is missing too: Coulomb friction" in both


def test_what_explains_most_is_first_and_doubt_is_told(diagnosis) -> None:
    missing = diagnosis.findings[0]
    wrong = replace(
        missing,
        key=EffectKey("viscous_damping", "hip"),
        number="damping",
        model_value=0.6,
        total=Estimate(0.9, 0.1, "N*m*s/rad"),
        probability=0.12,
        indistinguishable_from=(),
    )
    told = sentence(replace(diagnosis, findings=(missing, wrong)))
    assert told.startswith("Something is missing: Coulomb friction on the knee drive")
    assert "A number of the model is wrong too: the damping on the hip drive is" in told
    assert "(not sure: 12 % probable)" in told
    assert "not sure" not in sentence(replace(diagnosis, findings=(missing,)))


def test_an_improvement_tells_what_is_not_sure(improvement) -> None:
    assert "not sure" not in sentence(improvement)
    (first, *_) = improvement.diagnosis.findings
    doubted = replace(first, probability=0.31, indistinguishable_from=())
    told = sentence(replace(improvement, diagnosis=replace(improvement.diagnosis, findings=(doubted,))))
    assert "Coulomb friction on the knee drive" in told and "(not sure: 31 % probable)" in told


def test_what_stays_of_the_error_is_told_above_the_noise(diagnosis, comparison) -> None:
    """One number that is far off makes all else look small."""
    noise = comparison.noise_error
    before, after = (replace(comparison, error=times * noise, consistent=False) for times in (90.0, 5.1))
    far = replace(diagnosis, before=before, after=after, held_out=None)
    assert sentence(far).endswith(" The error falls from 90.0 times the noise to 5.1 times.")
    assert "falls from" not in sentence(replace(far, after=replace(after, consistent=True)))


def test_a_payload_off_its_site_is_told_by_its_mass() -> None:
    key = EffectKey("payload_mass", None, site="tool")
    mass = {"mass": Estimate(2.95, 0.03, "kg")}
    assert sized_phrase(key, mass) == "a payload of 2.95 ± 0.06 kg (95 %) at site 'tool'"
    off = sized_phrase(key, {**mass, "moment_x": Estimate(0.1, 0.01, "kg*m")})
    assert off == "a payload of 2.95 ± 0.06 kg (95 %) at site 'tool' (its centre is elsewhere)"


def test_several_wrong_numbers_of_links_are_the_answer() -> None:
    near = build.diagnosis().findings[:1]
    result = replace(build.unexplained(), by_links=0.97, near=near)
    assert sentence(result).startswith("Several numbers of the links are wrong. Other masses")
    assert "97 % of the torque that stays" in sentence(result)
    assert near_sentence(result).endswith("not certain: the numbers of all links together explain more.")
    assert "smooth curve" in near_sentence(replace(result, by_links=0.0))
