"""Masses behind a transmission that changes with the posture, found in runs of its closed chain in Drake."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from workbench import frf
from workbench.cli.record_own import played
from workbench.core import Recording
from workbench.diagnosis import improve
from workbench.importing import own_rig
from workbench.models import Model, read_model
from workbench.rigs import HiddenIn
from workbench.simulation import held_posture

MODEL = replace(read_model("four_bar"), axes=("thigh_drive", "crank"))


def runs(machine: Model, *hidden: HiddenIn) -> list[Recording]:
    """Multisines of both drives, their sum and their difference."""
    design = frf.multisine(
        MODEL.axes, name="m", period_s=2.0, rms=2.0, f_min_hz=0.5, f_max_hz=20.0, rate_hz=1000.0,
        hold=held_posture(MODEL, {}), mixing="orthogonal", periods=1, transient_periods=0, realisations=1,
        phases="random", driven="torque_feedforward", seed=3,
    )  # fmt: skip
    rig = own_rig(machine, hidden, seed=3)
    return [rig.run(each, k) for k, each in enumerate(played(design, MODEL))]


def heavier(folder: Path, mass: str, instead: str) -> Model:
    """The machine with another mass of one body of its closed chain."""
    assert MODEL.closed_chain is not None
    text, file = MODEL.closed_chain.file.read_text(), folder / "heavy.sdf"
    assert text.count(f"<mass>{mass}<") == 1
    file.write_text(text.replace(f"<mass>{mass}<", f"<mass>{instead}<"))
    return replace(MODEL, closed_chain=replace(MODEL.closed_chain, file=file))


def test_a_payload_beside_damping_goes_into_the_model() -> None:
    hidden = (
        HiddenIn("payload_mass", None, "actuator", {"mass": 0.2}),
        HiddenIn("viscous_damping", "crank", "actuator", {"damping": 0.1}),
    )
    result, better = improve(MODEL, runs(MODEL, *hidden))
    assert result.verdict == "consistent"
    found = {e.key.effect: e for e in better.effects}
    assert set(found) == {"payload_mass", "viscous_damping"}
    for each, name, true in (("payload_mass", "mass", 0.2), ("viscous_damping", "damping", 0.1)):
        estimate = found[each].parameters[name]
        assert abs(estimate.value - true) < 3.0 * estimate.std < 0.03 * true
    assert found["payload_mass"].key.site == "foot"
    assert (better.serial, better.carried, better.posture_dependent) == (MODEL.serial, None, True)
    (note,) = [n for n in result.notes if "searched for" in n]
    assert "lengths" in note and "springs" in note and "payload" not in note


def test_a_heavier_shank_is_found_and_said_by_its_own_name(tmp_path: Path) -> None:
    found = improve(MODEL, runs(heavier(tmp_path, "0.23", "0.33")))[0].diagnosis
    assert found is not None
    (finding,) = found.findings
    assert (finding.key.effect, finding.key.axis) == ("first_moment_error", "crank")
    mass = finding.parameters["mass"]
    assert abs(mass.value - 0.1) < 3.0 * mass.std < 0.01
    assert any("the crank link is the body 'shank'" in n and "'knee'" in n for n in found.notes)
    assert found.mend == ()


def test_a_torque_bias_is_said_to_be_perhaps_a_weight(tmp_path: Path) -> None:
    found = improve(MODEL, runs(heavier(tmp_path, "0.065", "0.165")))[0].diagnosis
    assert found is not None and [f.key.effect for f in found.findings] == ["torque_bias"]
    (note,) = [n for n in found.notes if "may instead come from a crank or rod" in n]
    (instead,) = re.findall(r"crank \((\S+) kg, not 0.065\)", note)
    assert abs(float(instead) - 0.165) < 0.03
    assert found.findings[0].probability < 0.85  # other bodies weigh as much as a bias
