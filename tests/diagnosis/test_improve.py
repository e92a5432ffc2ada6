"""One effect after the other is added until the noise is reached, and nothing that only follows."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import workbench as wb
from workbench.diagnosis import improve, with_mended_gains
from workbench.effects import load_model
from workbench.models import Linkage
from workbench.rigs import HiddenEffect

from .rig import recordings


def test_what_follows_a_stranger_is_added_only_when_asked_for() -> None:
    """Two springs follow one between the axes to the noise; what they leave goes with both positions."""
    hidden = HiddenEffect("cross_spring", parameters={"stiffness": 0.69, "rest": -0.158})
    training, held_out = recordings(hidden)
    node, better = improve(load_model("leg"), training, held_out, nearest=True)
    found = node.diagnosis
    assert found is not None
    assert (found.verdict, found.findings) == ("unexplained", ())
    assert found.shapes[0].share > 0.95
    assert found.shapes[0].quantities == ("position", "the position of hip")
    assert any("a description, not a cause" in line for line in found.evidence)
    assert (node.verdict, node.nearest, better.name) == ("unexplained", True, "leg_nearest")
    assert [a.key for a in better.effects[-len(node.steps) :]] == [s.key for s in node.steps]
    assert node.holdout_error_after is not None and node.holdout_error_before is not None
    assert node.holdout_error_after < 0.3 * node.holdout_error_before
    assert wb.compare(better, training).error == pytest.approx(node.error_after, rel=1e-6)
    assert node.held_out is not None
    before, after = node.held_out
    assert [e.recording.name for e in after.recordings] == [r.name for r in held_out]
    assert before.error == pytest.approx(node.holdout_error_before, rel=1e-6)
    assert after.error == pytest.approx(node.holdout_error_after, rel=1e-6)


def test_gains_that_recordings_state_wrongly_are_left_to_them(tmp_path: Path) -> None:
    """Beside friction that the model lacks. A model with the gains' effect would err once they are right."""
    friction = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.4})
    training, held_out = recordings(friction)
    named = []
    for r in (*training, *held_out):
        c = replace(r.controller, kp=(r.controller.kp[0] / 0.8, r.controller.kp[1]))
        wb.save_recording(replace(r, controller=c), tmp_path / f"{r.name}.toml")
        named.append(wb.load_recording(tmp_path / f"{r.name}.toml"))
    result, better = improve("leg", named[:-1], named[-1:])
    assert {s.key.effect for s in result.kept} == {"coulomb_friction", "controller_gain_error"}
    assert [s.key.effect for s in result.added] == ["coulomb_friction"]
    assert "controller_gain_error" not in {e.key.effect for e in better.effects}
    assert result.diagnosis is not None and "kp of hip is 62.5 and should be " in result.diagnosis.mend[0]
    mended = with_mended_gains(named, result.diagnosis)
    assert mended[0].controller.kp == pytest.approx(training[0].controller.kp, rel=0.01)
    assert wb.compare(better, mended[:-1]).error == pytest.approx(result.error_after, rel=1e-6)
    assert wb.compare(better, mended[-1:]).error == pytest.approx(result.holdout_error_after, rel=1e-6)
    assert wb.compare(better, named[:-1]).error > 2.0 * result.error_after, "the recordings are still wrong"


def test_what_only_held_out_motion_shows_is_no_consistent_model() -> None:
    friction = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.4})
    (training, _), (_, held_out) = recordings(), recordings(friction)
    node, _ = improve(load_model("leg"), training, held_out)
    found = node.diagnosis
    assert found is not None
    assert (node.verdict, found.verdict, node.steps, found.findings) == ("unexplained", "unexplained", (), ())
    assert "fit those and hold out others" in found.evidence[0]


def test_the_ladder_from_kin_only() -> None:
    training, held_out = recordings()
    model = load_model("leg_kin_only")
    result, better = improve(model, training, held_out)
    names = [s.key.effect for s in result.steps]
    assert names == ["actuator_inertia_coupling", "linkage_inertia", "linkage_gravity"]
    errors = [result.error_before, *(s.error for s in result.steps)]
    held = [result.holdout_error_before, *(s.holdout_error for s in result.steps)]
    assert all(np.diff(errors) < 0) and all(np.diff([h for h in held if h is not None]) < 0)
    assert result.verdict == "consistent"
    assert [e.key.effect for e in better.effects] == names


def test_a_linkage_that_was_not_identified_is_fitted() -> None:
    training, held_out = recordings()
    act = load_model("leg_s3n_act")
    unknown = replace(act, linkage=Linkage(identified=False))
    result, better = improve(unknown, training, held_out)
    fitted = [e for e in better.effects if e.key.effect == "linkage_inertia"]
    rivals = {k.effect for s in result.steps for k in s.indistinguishable_from}
    assert result.error_after < 0.3 * result.error_before
    assert fitted or "linkage_inertia" in rivals or "payload_mass" in {s.key.effect for s in result.steps}
