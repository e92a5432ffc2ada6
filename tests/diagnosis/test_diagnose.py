"""A hidden effect is named, with its size; where nothing is hidden or nothing moves, none is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from workbench.core import EffectKey, InputError
from workbench.diagnosis import diagnose, improve
from workbench.effects import load_model
from workbench.recordings import load_recordings
from workbench.rigs import HiddenEffect

from ..data_helpers import LEG
from .rig import recordings

#: The others are in `test_hidden`.
HIDDEN = [
    HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.25}),
    HiddenEffect("payload_mass", parameters={"mass": 0.08}),
]


def check_named(hidden: HiddenEffect) -> None:
    """It is found, it alone, with its size, and explains all."""
    training, held_out = recordings(hidden)
    found = diagnose(load_model("leg"), training, held_out)
    key = EffectKey(hidden.effect, hidden.axis, hidden.location)
    assert found.verdict == "missing_effect"
    first = found.findings[0]
    assert len(found.findings) == 1
    assert key in (first.key, *first.indistinguishable_from)
    assert first.holdout_error_before is not None and first.holdout_error_after is not None
    assert first.holdout_error_after < 0.6 * first.holdout_error_before
    assert found.after is not None and found.after.error < 1.1 * found.noise_error
    if hidden.effect == "coulomb_friction":
        assert any("knee is proportional to the sign of speed (slope 0.2" in line for line in first.evidence)
    assert found.evidence == ()  # nothing is left to be explained
    if first.key == key:
        for name, value in hidden.parameters.items():
            estimate = first.parameters[name]
            assert abs(estimate.value - value) < max(4 * estimate.std, 0.03 * abs(value)), (name, estimate)
            assert 0 < estimate.std < 0.2 * abs(value)


@pytest.mark.parametrize("hidden", HIDDEN, ids=lambda h: f"{h.effect}@{h.axis}")
def test_names_the_hidden_effect_and_its_size(hidden: HiddenEffect) -> None:
    check_named(hidden)


def test_a_leg_without_hidden_effect_is_consistent() -> None:
    training, held_out = recordings()
    result, model = improve(load_model("leg"), training, held_out)
    assert (result.verdict, result.steps) == ("consistent", ())
    assert model.effects == load_model("leg").effects
    assert result.diagnosis is not None and result.diagnosis.unexplained_fraction == 0.0


def test_a_log_of_a_few_rows_has_no_verdict() -> None:
    (run, *_), _ = recordings()
    few = replace(
        run, time=run.time[:39], signals={k: v[:39] for k, v in run.signals.items()}, valid=run.valid[:39]
    )
    with pytest.raises(InputError, match="39 rows are too few"):
        diagnose(load_model("leg"), [few])


def test_a_machine_that_never_moved_has_no_verdict() -> None:
    (log, *_), _ = recordings()
    still = {name: np.zeros_like(values) for name, values in log.signals.items()}
    with pytest.raises(InputError, match="no axis moves"):
        diagnose(load_model("leg"), [replace(log, signals=still)])


def test_friction_in_data_from_an_independent_simulator() -> None:
    folder = LEG / "friction"
    training = load_recordings([folder / "chirp_knee.toml", folder / "slow.toml"])
    held_out = load_recordings([folder / "validation.toml"])
    found = diagnose(load_model("leg"), training, held_out)
    torque = found.findings[0].parameters["torque"]
    assert found.findings[0].key == EffectKey("coulomb_friction", "knee")
    assert abs(torque.value - 0.25447) < 1.96 * torque.std
    assert torque.std < 0.005
