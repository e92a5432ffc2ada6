"""What recordings on the ground tell of it, and what those in the air do not."""

from __future__ import annotations

import pytest

from workbench.core import EffectKey
from workbench.diagnosis import diagnose
from workbench.diagnosis.data import gather
from workbench.diagnosis.screening.ground_effects import unobservable_effects
from workbench.diagnosis.screening.screen import screen
from workbench.diagnosis.screening.sensitivity import Linearisation
from workbench.effects import load_model
from workbench.rigs import HiddenEffect, Plate, VirtualLeg, plate_experiments

MODEL = load_model("leg_on_plate")
CONTACTS = {EffectKey("contact_compliance", None), EffectKey("ground_friction", None)}


def recorded(
    *hidden: HiddenEffect, plate: Plate | None = None, names=("step", "slide", "walk"), seed: int = 2
):
    chosen = [e for e in plate_experiments(duration=0.8) if e.name in names]
    return VirtualLeg(hidden, seed=seed, plate=plate).run(chosen)


@pytest.mark.parametrize(
    ("effect", "values"),
    [
        ("contact_compliance", {"stiffness": 2e4, "damping": 100.0}),
        ("ground_friction", {"coefficient": 0.35}),
    ],
)
def test_a_contact_that_the_model_has_wrong_is_found(effect: str, values: dict[str, float]) -> None:
    *training, judge = recorded(HiddenEffect(effect, parameters=values), plate=Plate())
    found = diagnose(MODEL, training, [judge])
    assert found.verdict == "missing_effect"
    assert [f.key for f in found.findings] == [EffectKey(effect, None)]
    for name, value in values.items():
        estimate = found.findings[0].parameters[name]
        assert abs(estimate.value - value) < 3.0 * estimate.std < 0.2 * value


def test_nothing_hidden_is_nothing_found_and_no_slip_is_silent() -> None:
    found = diagnose(MODEL, recorded(plate=Plate(), names=("press",)))
    assert found.verdict == "consistent" and not found.findings
    assert EffectKey("ground_friction", None) in found.not_excited
    assert EffectKey("contact_compliance", None) not in found.not_excited


def test_in_the_air_no_contact_is_a_candidate() -> None:
    hidden = HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.2})
    data, simulated = gather(MODEL, recorded(hidden), (), seed=0)
    linearisation = Linearisation.of(MODEL, data, simulated.clean, len(data.recordings))
    candidates = screen(linearisation, data)
    assert not {c.key for c in candidates} & CONTACTS
    assert set(unobservable_effects(linearisation)) >= CONTACTS
