"""The field's simulator obeys mechanics, and its cases and marks are what they say."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from exam.answers import with_truth
from exam.field.cases import FAMILIES, KINDS, field_cases
from exam.field.chain import GRAVITY, Link, Machine, loaded, mjcf, numbers
from exam.field.dynamics import acceleration, energy, needed
from exam.field.judging import judged, refused
from exam.field.machines import MACHINES, draw_machine
from exam.field.march import STEP, step
from exam.field.plant import Field, Way, has, recorded, stated, told
from exam.second.hidden import Hidden

from workbench.core import Diagnosis, Disagreement, EffectKey
from workbench.simulation import Run, simulate

NOBODY = np.zeros((0, 6))
PLAIN = {"damping": 0.0, "friction": 0.0}
ARM = draw_machine("arm", 3)
ARMS = field_cases("arm", 7)


def bare(machine: Machine) -> Machine:
    """Without friction and damping."""
    return replace(machine, links=tuple(replace(link, **PLAIN) for link in machine.links))


@pytest.mark.parametrize("family", FAMILIES)
def test_torques_are_those_of_mujoco(family: str) -> None:
    machine, draw = bare(draw_machine(family, 5)), np.random.default_rng(1)
    model = mujoco.MjModel.from_xml_string(mjcf(machine))
    data, out = mujoco.MjData(model), np.zeros(len(machine.axes))
    for _ in range(5):
        data.qpos[:], data.qvel[:], data.qacc[:] = draw.normal(size=(3, len(out))) * [[1.0], [4.0], [20.0]]
        mujoco.mj_inverse(model, data)
        needed(data.qpos.copy(), data.qvel.copy(), data.qacc.copy(), GRAVITY, numbers(machine.links), out)
        np.testing.assert_allclose(out, data.qfrc_inverse, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("family", FAMILIES)
def test_acceleration_undoes_torque(family: str) -> None:
    links, draw = numbers(draw_machine(family, 6).links), np.random.default_rng(2)
    q, w, a = draw.normal(size=(3, len(links.mass)))
    torque = np.zeros(len(q))
    needed(q, w, a, GRAVITY, links, torque)
    back = acceleration(q, w, torque + links.damping * w, GRAVITY, links)
    np.testing.assert_allclose(back, a, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("family", MACHINES)
def test_free_motion_keeps_its_energy(family: str) -> None:
    machine = bare(draw_machine(family, 8))
    links, n = numbers(machine.links), len(machine.axes)
    q, w = np.array(machine.posture) + 0.3, np.full(n, 0.5)
    start, swing = energy(q, w, GRAVITY, links), 0.0
    for k in range(5000):
        step(k * STEP, STEP, q, w, np.zeros(n), np.zeros(n), links, NOBODY)
        swing = max(swing, 0.5 * float(links.armature @ w**2))
    assert energy(q, w, GRAVITY, links) == pytest.approx(start, abs=1e-6 * (1.0 + swing))


def slider(friction: float) -> Machine:
    link = Link(
        "x", (1, 0, 0), (0, 0, 0), 1.5, (0, 0, 0), (1e-3, 1e-3, 1e-3), 0.5, 0.0, friction, slides=True
    )
    return Machine("slider", (link,), (0, 0, 0), (0.0,), (0.0,), (0.0,), (0.1,))


def test_dry_friction_stops_a_mass_where_it_should_and_holds_it() -> None:
    links = numbers(slider(3.0).links)
    q, w, rub = np.zeros(1), np.array([1.2]), np.zeros(1)
    places = []
    for k in range(8000):
        step(k * STEP, STEP, q, w, np.array([1.0]), rub, links, NOBODY)
        places.append(q[0])
    # 2 kg slowed by 3 N against a push of 1 N
    assert q[0] == pytest.approx(1.2**2 / 2 / (2.0 / 2.0), rel=1e-3)
    assert w[0] == 0.0 and places[-1] == places[-1500] and rub[0] == pytest.approx(-1.0)
    step(0.0, STEP, q, w, np.array([3.1]), rub, links, NOBODY)
    assert w[0] == pytest.approx(0.1 / 2.0 * STEP, rel=1e-6)


def test_friction_holds_some_axes_while_others_move() -> None:
    links = numbers(ARM.links)
    rest = np.zeros(3)
    needed(np.array(ARM.posture), rest, rest, GRAVITY, links, gravity := np.zeros(3))
    q, w, rub, push = np.array(ARM.posture), np.zeros(3), np.zeros(3), gravity + np.array([0.0, 0.0, 3.0])
    for k in range(300):
        step(k * STEP, STEP, q, w, push, rub, links, NOBODY)
    assert q[0] == ARM.posture[0] and q[2] > ARM.posture[2] + 0.01


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
def test_an_exam_is_the_same_for_the_same_seed_and_its_beginning_is_mixed(family: str) -> None:
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


def test_beside_a_stranger_the_verdict_says_that_something_is_left() -> None:
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
