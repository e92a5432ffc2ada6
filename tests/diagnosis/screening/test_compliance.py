"""Springs, gaps and a soft base are named, with their size, and asked for only where something gives way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.diagnosis.rig import applied, asked, recordings
from workbench.core import EffectKey
from workbench.diagnosis import diagnose
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.fitting.refinement import with_candidate
from workbench.diagnosis.hypothesis import Hypothesis
from workbench.diagnosis.screening.compliance import (
    compliance_candidates,
    equivalent_at_drive,
    equivalents_at_joint,
)
from workbench.diagnosis.screening.sensitivity import Linearisation
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

LEG = load_model("leg")
HIDDEN = [
    HiddenEffect("joint_compliance", "hip", parameters={"stiffness": 1300.0, "damping": 2.0}),
    HiddenEffect("joint_compliance", "knee", parameters={"stiffness": 180.0, "damping": 0.27}),
    HiddenEffect("backlash", "hip", parameters={"gap": 0.014, "stiffness": 350.0}),
    HiddenEffect("backlash", "knee", parameters={"gap": 0.01, "stiffness": 300.0}),
    HiddenEffect("backlash", "hip", parameters={"gap": 0.012, "stiffness": 400.0, "damping": 0.8}),
    HiddenEffect("backlash", "knee", parameters={"gap": 0.01, "stiffness": 350.0, "damping": 0.7}),
    HiddenEffect("base_compliance", parameters={"stiffness": 3e4, "damping": 90.0, "mass": 5.5}),
]
# crank and coupler are ahead of it; with them behind it, its stiffness would come out a tenth too large
IN_THE_PIN = HiddenEffect("joint_compliance", "knee", "joint", {"stiffness": 128.0, "damping": 0.13})


def str_of(hidden: HiddenEffect) -> str:
    damped = "damped " * (hidden.effect == "backlash" and "damping" in hidden.parameters)
    return f"{damped}{hidden.effect}@{hidden.axis}({hidden.location})"


def linearisation(*hidden: HiddenEffect) -> Linearisation:
    training, _ = recordings(*hidden)
    return asked(LEG, training).linearisation


def check_told(hidden: HiddenEffect) -> None:
    """The torque along the motion tells it from other axes, with its numbers."""
    made = linearisation(hidden)
    candidates = {c.key: c for c in compliance_candidates(made, 1.0)}
    key = EffectKey(hidden.effect, hidden.axis)
    assert key in candidates
    axes = {k.axis for k, c in candidates.items() if c.test_loss <= 5 * candidates[key].test_loss}
    assert axes == {hidden.axis}
    found = candidates[key]
    if hidden.effect == "base_compliance":
        assert found.shape["mass"] == pytest.approx(hidden.parameters["mass"], rel=0.2)
        return
    for name, value in hidden.parameters.items():
        if (hidden.effect, name) == ("backlash", "damping"):
            name, value = "retardation", value / hidden.parameters["stiffness"]
        assert found.shape[name] == pytest.approx(value, rel=0.15), name


@pytest.mark.parametrize("hidden", HIDDEN, ids=str_of)
def test_the_torque_alone_tells_what_gives_way_and_how_much(hidden: HiddenEffect) -> None:
    check_told(hidden)


def test_a_spring_is_asked_beside_a_gap_that_follows_closer() -> None:
    spring = HiddenEffect("joint_compliance", "knee", "joint", {"stiffness": 123.3, "damping": 0.19})
    made = linearisation(spring)
    left = {c.key.effect: c.test_loss for c in compliance_candidates(made, 1.0)}
    assert left["joint_compliance"] > 5 * left["backlash"], "what gaps pass on is drawn to the torque"


def test_a_second_spring_is_asked_with_the_first() -> None:
    hip = HiddenEffect("joint_compliance", "hip", parameters={"stiffness": 500.0, "damping": 1.0})
    knee = HiddenEffect("joint_compliance", "knee", parameters={"stiffness": 300.0, "damping": 0.4})
    keys = [EffectKey(h.effect, h.axis) for h in (hip, knee)]
    training, _ = recordings(hip, knee)
    mixed = applied(LEG, keys[0], stiffness=540.0, damping=1.1)
    problem = asked(LEG.with_effect(mixed), training)
    made = problem.linearisation
    candidates = {c.key: c for c in compliance_candidates(made, 1.0, (mixed,))}
    found = candidates[keys[1]]
    assert found.test_loss < 0.2
    assert found.shape["stiffness"] == pytest.approx(300.0, rel=0.05)
    assert found.beside[keys[0]]["stiffness"] == pytest.approx(500.0, rel=0.05)
    before = replace(problem.start, hypothesis=Hypothesis(LEG, (mixed,)))
    (both,) = fit([with_candidate(made, found, before)], problem.data)
    assert both is not None
    values = {a.key: a.values["stiffness"] for a in both.hypothesis.free}
    assert values == {keys[0]: pytest.approx(500.0, rel=0.01), keys[1]: pytest.approx(300.0, rel=0.01)}


def test_friction_asks_for_no_spring() -> None:
    made = linearisation(HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.4}))
    assert not compliance_candidates(made, 1.0)


@pytest.mark.parametrize("hidden", [HIDDEN[1], HIDDEN[4], HIDDEN[6], IN_THE_PIN], ids=str_of)
def test_names_it_with_its_size(hidden: HiddenEffect) -> None:
    training, held_out = recordings(hidden)
    found = diagnose(LEG, training, held_out)
    first = found.findings[0]
    assert (found.verdict, len(found.findings)) == ("missing_effect", 1)
    assert first.key == EffectKey(hidden.effect, hidden.axis, hidden.location)
    damped = hidden.effect == "backlash" and "damping" in hidden.parameters
    assert ("flank_retardation_s" in found.settled) == damped
    for name, estimate in first.parameters.items():
        value = hidden.parameters[name]
        assert abs(estimate.value - value) < 3 * estimate.std, (name, estimate)
        assert 0 < estimate.std < 0.2 * value


def test_a_pin_that_one_drive_turns_is_that_drive() -> None:
    drive, pin = EffectKey("backlash", "knee"), EffectKey("backlash", "knee", "joint")
    bare = load_model("leg_s3n_act")
    assert equivalent_at_drive(bare, pin) == drive and equivalents_at_joint(bare, drive) == (pin,)
    # crank and coupler are ahead of the pin and behind the drive
    assert equivalent_at_drive(LEG, pin) is None and equivalents_at_joint(LEG, drive) == ()
    # without the drives' coupling a tree cannot have a spring at the knee's drive
    assert equivalent_at_drive(load_model("leg_kin_only"), pin) is None
    assert equivalents_at_joint(LEG, EffectKey("backlash", "hip")) == ()
    assert np.count_nonzero(LEG.transmission[:, 0]) == 2
