"""A limit and a line that falls with speed: which is named, and when both are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import workbench as wb
from tests.bench_arm import bench_arm
from tests.rotor import pushed, torn
from workbench.core import EffectKey, Estimate, Recording
from workbench.diagnosis.data import Data, gather
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.fitting.refinement import with_candidate
from workbench.diagnosis.hypothesis import Fit, applied_effect
from workbench.diagnosis.naming import link_instead, named_beside
from workbench.diagnosis.problem import starting_fit
from workbench.diagnosis.screening.candidate import Candidate
from workbench.diagnosis.screening.command_path import off_command_path
from workbench.diagnosis.screening.screen import screen
from workbench.diagnosis.screening.sensitivity import Linearisation
from workbench.effects import load_model
from workbench.models import AppliedEffect

_LINE, _LIMIT = EffectKey("speed_torque_limit", "m"), EffectKey("torque_saturation", "m")


def stepped(folder: Path, seed: int, **limits: float) -> Recording:
    """Steps from rest, at the limit as long as the drive gathers speed."""
    generator = np.random.default_rng(seed)
    reference = np.repeat(generator.uniform(-0.12, 0.12, 16), 250)
    return pushed(folder, reference, (8.0, 0.25), seed=seed, name=f"steps {seed}", **limits)


def positions_of(log: Recording) -> Recording:
    """A log of which nobody measured the torque: it says nothing of the drive by itself."""
    return replace(log, signals={n: x for n, x in log.signals.items() if n != "torque_measured"})


def screened(folder: Path, runs: list[Recording]) -> tuple[Linearisation, Data, Fit, Sequence[Candidate]]:
    """The rotor without limits on its logs, and what might be missing."""
    model = wb.load_model(str(folder / "rotor.xml"))
    data, simulated = gather(model, runs, (), 0)
    start = starting_fit(model, data, simulated.clean)
    linearisation = Linearisation.of(model, data, start.simulated, len(runs))
    return linearisation, data, start, screen(linearisation, data)


@pytest.mark.parametrize(
    ("limits", "key"), [({"limit": 0.5}, _LIMIT), ({"stall": 0.52, "fastest": 40.0}, _LINE)]
)
def test_what_was_met_at_many_speeds_is_told_apart(
    tmp_path: Path, limits: dict[str, float], key: EffectKey
) -> None:
    runs = [stepped(tmp_path, seed, **limits) for seed in range(3)]
    found = wb.diagnose(wb.load_model(str(tmp_path / "rotor.xml")), runs[:2], runs[2:])
    assert [f.key for f in found.findings] == [key]
    assert found.findings[0].indistinguishable_from == ()


def test_a_line_that_does_not_fall_is_a_limit(tmp_path: Path) -> None:
    # so far beyond the limit that no run is reproduced, and one parameter more always leaves less
    runs = [
        pushed(tmp_path, a * torn(2000), (60.0, 0.4), limit=1.2, seed=k, name=f"torn {k}")
        for k, a in enumerate((1.0, 0.7, 0.4))
    ]
    found = wb.diagnose(wb.load_model(str(tmp_path / "rotor.xml")), runs[:2], runs[2:])
    assert found.findings[0].key == _LIMIT
    assert found.findings[0].parameters["limit"].value == pytest.approx(1.2, rel=0.01)


@pytest.mark.parametrize("limits", [{"limit": 0.5}, {"stall": 0.6, "fastest": 15.0}])
def test_a_line_that_explains_as_much_is_named_if_it_falls(tmp_path: Path, limits: dict[str, float]) -> None:
    runs = [stepped(tmp_path, seed, **limits) for seed in range(2)]
    if "stall" in limits:  # else the channel would have settled it
        runs = [positions_of(r) for r in runs]
    linearisation, data, start, candidates = screened(tmp_path, runs)
    chosen = next(c for c in candidates if c.key == _LIMIT)
    [found] = fit([with_candidate(linearisation, chosen, start)], data)
    assert found is not None

    def beside(test_loss: float) -> list[EffectKey]:
        as_if = replace(found, test_loss=test_loss, training_loss=test_loss)
        return [c.key for c, _ in named_beside(linearisation, candidates, chosen, as_if, start, data)]

    assert beside(np.inf) == ([] if "limit" in limits else [_LINE])
    assert beside(0.0) == []  # what explains less is not named, whatever it is


def test_the_torque_behind_a_command_leaves_one_form_of_a_limit(tmp_path: Path) -> None:
    """However the loop is thrown about: what was asked and what was given are both in the log."""
    falling, level = ({"stall": 0.6, "fastest": 15.0}, {"limit": 0.5})
    there = [
        {c.key for c in screened(tmp_path, [stepped(tmp_path, 0, **limits)])[-1]} & {_LIMIT, _LINE}
        for limits in (falling, level)
    ]
    assert there == [{_LINE}, {_LIMIT, _LINE}], "a line that hardly falls is a limit too"


def test_a_fit_that_leaves_what_the_channel_shows_is_known(tmp_path: Path) -> None:
    linearisation, data, start, candidates = screened(
        tmp_path, [stepped(tmp_path, 0, stall=0.6, fastest=15.0)]
    )
    line = next(c for c in candidates if c.key == _LINE)
    [found] = fit([with_candidate(linearisation, line, start)], data, 1)
    assert found is not None and not off_command_path(linearisation, line, found)
    (own,) = found.hypothesis.free
    values = {**own.values, "no_load_speed": 1.25 * own.values["no_load_speed"]}
    other = replace(found.hypothesis, free=(applied_effect(linearisation.model, own, values),))
    assert off_command_path(linearisation, line, replace(found, hypothesis=other))


@pytest.mark.parametrize(
    ("more", "told"), [({}, ()), ({"moment_x": 0.01}, (EffectKey("first_moment_error", "bend"),))]
)
def test_a_body_at_a_site_may_be_other_numbers_of_its_link(tmp_path: Path, more, told) -> None:
    """A point that explains as much with one number is no link whose three are wrong."""
    values = {name: Estimate(x, 0.0, "") for name, x in {"mass": 0.5, **more}.items()}
    payload = AppliedEffect(EffectKey("payload_mass", None, site="tip"), values)
    assert link_instead(load_model(bench_arm(tmp_path)), payload) == told
