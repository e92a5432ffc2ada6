"""The field's simulator obeys mechanics, and its cases and marks are what they say."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from exam.answers import with_truth
from exam.field.cases import FAMILIES, KINDS, field_cases
from exam.field.judging import judged, refused
from exam.field.plant import Field, Way, has, recorded, stated, told
from exam.second.hidden import Hidden
from workbench_exam.plants.chain import loaded
from workbench_exam.plants.files import mjcf
from workbench_exam.plants.machines import draw_machine

from workbench.core import Diagnosis, Disagreement, EffectKey
from workbench.simulation import Run, simulate

ARM = draw_machine("arm", 3)
ARMS = field_cases("arm", 7)


@pytest.mark.parametrize(
    "hidden",
    [
        [],
        [Hidden("first_moment_error", "bend", "actuator", {"along": 0.06, "across": 0.0})],
        [Hidden("link_inertia_error", "bend", "actuator", {"inertia": -0.01})],
        [
            Hidden("viscous_damping", "lift", "actuator", {"damping": -0.5}),
            Hidden("coulomb_friction", "yaw", "actuator", {"torque": 0.3}),
            Hidden("reflected_inertia", "bend", "actuator", {"inertia": -0.03}),
        ],
    ],
    ids=lambda hidden: "+".join(h.effect for h in hidden) or "clean",
)
def test_the_model_with_what_it_lacks_moves_as_the_machine(hidden: list[Hidden], tmp_path: Path) -> None:
    way = Way(duration=3.0, tick=1e-3, every=5, positions_alone=True)
    case = Field("arm", 3, tuple(hidden), way=way)
    model, recordings = recorded(case, tmp_path)
    measured = told(case, recordings)[1]
    right, wrong = (simulate([Run(m, measured)])[0] for m in (with_truth(model, hidden), model))
    apart = [np.abs(r.signals["position"] - measured.signals["position"]).max() for r in (right, wrong)]
    assert apart[0] < 6e-4
    assert not hidden or apart[1] > 5 * apart[0]


@pytest.mark.parametrize("name", ["rough_patch", "follower", "tone"])
def test_a_stranger_shows(name: str, tmp_path: Path) -> None:
    case = next(c.field for c in ARMS if c.field and any(h.effect == name for h in c.field.strangers))
    short = replace(case, way=Way(duration=2.0))
    strange, usual = (recorded(c, tmp_path)[1][1] for c in (short, replace(short, strangers=())))
    assert np.abs(strange.signals["position"] - usual.signals["position"]).max() > 1e-3


def test_one_recording_of_several_is_of_another_unit(tmp_path: Path) -> None:
    usual, odd = (
        recorded(Field("arm", 3, way=Way(duration=0.5, **other)), tmp_path)[1]
        for other in ({}, {"odd": 1, "unit": 10.0})
    )
    for number, (a, b) in enumerate(zip(usual, odd, strict=True)):
        times = 10.0 if number == 1 else 1.0
        np.testing.assert_allclose(times * a.signals["torque_measured"], b.signals["torque_measured"])


def test_no_torque_is_shown_where_no_motor_is(tmp_path: Path) -> None:
    torque = recorded(Field("cart", 3, way=Way(duration=0.5)), tmp_path)[1][1].signals["torque_measured"]
    assert torque[:, 0].any() and not torque[:, 1].any()


def test_a_load_at_the_tip_is_the_same_as_two_bodies() -> None:
    link = loaded(ARM.links[-1], 0.7, ARM.tip)
    own, tip = np.array(ARM.links[-1].centre), np.array(ARM.tip)
    assert link.mass * np.array(link.centre) == pytest.approx(ARM.links[-1].mass * own + 0.7 * tip)
    about_hinge = link.inertia[1] + link.mass * link.centre[0] ** 2
    before = ARM.links[-1].inertia[1] + ARM.links[-1].mass * own[0] ** 2
    assert about_hinge == pytest.approx(before + 0.7 * tip[0] ** 2)


@pytest.mark.parametrize("family", FAMILIES)
def test_an_exam_is_the_same_for_its_seed_and_begins_mixed(family: str) -> None:
    cases, other = field_cases(family, 7), field_cases(family, 8)
    assert cases == field_cases(family, 7)
    assert len({c.name for c in cases}) == len(cases) and not {c.seed for c in cases} & {
        c.seed for c in other
    }
    if family != "quadruped":
        assert set(Counter(c.kind for c in cases[:12])) == set(KINDS)
        assert len({h.effect for c in cases if c.kind == "wrong_number" for h in c.hidden}) >= 3


@pytest.mark.parametrize("case", [c for f in FAMILIES for c in field_cases(f, 2)], ids=lambda c: c.name)
def test_a_file_states_the_machine_without_what_is_hidden(case) -> None:
    machine = case.field.machine
    file = stated(machine, case.hidden)
    for h in case.hidden:
        lacks = next(iter(h.parameters.values()))
        mass = [m.links[m.index(h.axis)].mass for m in (machine, file)]
        assert mass[0] - mass[1] == pytest.approx(h.parameters.get("mass", 0.0))
        assert has(file, h.effect, h.axis) + lacks == pytest.approx(has(machine, h.effect, h.axis))
    mujoco.MjModel.from_xml_string(mjcf(file))  # which bodies there can be, it says


def diagnosis(**more) -> Diagnosis:
    return Diagnosis("arm", "missing_effect", 1.0, 1.0, (), 0.0, (), None, (), **more)


def line(**more) -> dict:
    found = {"key": "viscous_damping@lift", "is": "right", "effect": "viscous_damping", "axis": "lift"}
    damping = {"value": 0.2, "std": 0.01, "truth": 0.2}
    marks = {"findings": [{**found, "parameters": {"damping": damping}}], "visible": True, "good": True}
    return {**marks, "verdict": "missing_effect", "outcome": "right"} | more


CASE = Field("arm", 3, (Hidden("viscous_damping", "lift", "actuator", {"damping": 0.2}),))


def test_a_value_may_be_off_by_a_tenth_of_what_the_machine_has() -> None:
    own = has(CASE.machine, "viscous_damping", "lift")
    for off, good in ((0.08, True), (0.12, False)):
        marks = line()
        marks["findings"][0]["parameters"]["damping"]["value"] = 0.2 + off * own
        assert judged(CASE, "wrong_number", marks, diagnosis())["good"] is good


def test_beside_a_stranger_the_verdict_says_more_is_left() -> None:
    for floor, verdict, good in (
        (5.0, "partly_explained", True),
        (5.0, "missing_effect", False),
        (1.05, "missing_effect", True),
        (1.05, "partly_explained", False),
    ):
        marks = line(verdict=verdict, floor=floor, floor_noise=1.0, before=10.0)
        assert judged(CASE, "beside_stranger", marks, diagnosis())["good"] is good


def test_recordings_that_do_not_go_together_have_to_be_said_to() -> None:
    apart = Disagreement(("slow", "sweep"), EffectKey("torque_constant_error", "lift"), (1.0, 0.1))
    silent = line(findings=[])
    assert judged(CASE, "two_units", silent, diagnosis(disagreeing=(apart,)))["outcome"] == "disagreeing"
    assert judged(CASE, "two_units", silent, diagnosis(disagreeing=(apart,)))["good"]
    assert not judged(CASE, "two_units", silent, diagnosis())["good"]
    assert not judged(CASE, "two_units", line(), diagnosis(disagreeing=(apart,)))["good"]
    assert not judged(CASE, "wrong_number", line(), diagnosis(disagreeing=(apart,)))["good"]
    assert refused("two_units", "slow.toml: its torque is in another unit than sweep's")["good"]
    assert "failed" in refused("two_units", "slow.toml: cannot be read")
    assert "failed" in refused("clean", "slow.toml: its torque is in another unit than sweep's")
