"""Effects on links behind a transmission that changes, against closed chains in Drake that have them."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.mechanism_log import multisines
from tests.simulation.make import having, hold_slopes_to_differences
from workbench.comparison import replay_of
from workbench.core import EffectKey, Mechanism, Recording
from workbench.effects import compile_plant, effect_named, into_file
from workbench.mechanism import ClosedChain
from workbench.models import Model, Placement, read_model
from workbench.s3n import on_drives
from workbench.simulation import Track, required_torque

FOUR_BAR = read_model("four_bar")
assert FOUR_BAR.closed_chain is not None


def shank(folder: Path, *, mass: float = 0.23, centre: float = 0.141006211, more: float = 0.0) -> Mechanism:
    """The four-bar with another shank [kg, m], of so much more inertia about its centre [kg m^2]."""
    assert FOUR_BAR.closed_chain is not None
    text = FOUR_BAR.closed_chain.file.read_text()
    wrong = {"0 0 -0.141006211": f"0 0 {-centre}", "<mass>0.23<": f"<mass>{mass}<"}
    wrong |= {f"<{i}>0.002381967<": f"<{i}>{0.002381967 + more}<" for i in ("ixx", "iyy")}
    for old, new in wrong.items():
        assert len(re.findall(re.escape(old), text)) == 1
        text = text.replace(old, new)
    (folder / "wrong.sdf").write_text(text)
    return replace(FOUR_BAR.closed_chain, file=folder / "wrong.sdf")


def along(model: Model, chain: ClosedChain, seed: int) -> tuple[Track, np.ndarray]:
    """Some states of the drives, and the torque (N, n) that the closed chain and the rotors need there."""
    assert model.closed_chain is not None
    low, high = np.array(model.closed_chain.limits).T
    generator = np.random.default_rng(seed)
    middle, half = 0.5 * (low + high), 0.35 * (high - low)
    joints = middle + half * generator.uniform(-1.0, 1.0, (6, model.size))
    q = np.array([chain.drive_position(each) for each in joints])
    v, a = generator.normal(size=(2, *q.shape)) * [[[3.0]], [[30.0]]]
    found = [chain.reduced_dynamics(*state) for state in zip(q, v, strict=True)]
    rotors = np.array(model.actuators.inertia) * a + np.array(model.actuators.damping) * v
    links = [r.mass @ row + r.bias - r.gravity for r, row in zip(found, a, strict=True)]
    return Track(q, v, a), np.array(links) + rotors


@pytest.mark.parametrize("name", ["four_bar", "five_bar", "ankle"])
def test_a_payload_is_the_closed_chain_that_carries_it(name: str) -> None:
    model = read_model(name)
    assert model.closed_chain is not None
    track, truth = along(model, ClosedChain(model.closed_chain, 0.4), seed=1)
    plant = compile_plant(on_drives(having(model, EffectKey("payload_mass", None), mass=0.4)))
    np.testing.assert_allclose(required_torque(plant, track), truth, atol=1e-6 * np.abs(truth).max())
    bare = required_torque(compile_plant(on_drives(model)), track)
    assert np.abs(bare - truth).max() > 0.05 * np.abs(truth).max()


@pytest.mark.parametrize(
    ("effect", "found", "true"),
    [
        ("first_moment_error", {"along": 0.23 * 0.03, "across": 0.0}, {"centre": 0.171006211}),
        (
            "first_moment_error",
            {"along": 0.1 * 0.141006211, "across": 0.0, "mass": 0.1},
            {"mass": 0.33},
        ),
        ("link_inertia_error", {"inertia": 0.002}, {"more": 0.002}),
    ],
)
def test_a_wrong_link_is_the_closed_chain_that_has_it(
    tmp_path: Path, effect: str, found: dict[str, float], true: dict[str, float]
) -> None:
    track, truth = along(FOUR_BAR, ClosedChain(shank(tmp_path, **true)), seed=2)
    plant = compile_plant(on_drives(having(FOUR_BAR, EffectKey(effect, "knee"), **found)))
    np.testing.assert_allclose(required_torque(plant, track), truth, atol=1e-6 * np.abs(truth).max())


def test_slopes_are_the_torque_s_with_what_effects_change() -> None:
    assert FOUR_BAR.closed_chain is not None
    track, _ = along(FOUR_BAR, ClosedChain(FOUR_BAR.closed_chain), seed=3)
    plant = compile_plant(on_drives(having(FOUR_BAR, EffectKey("payload_mass", None), mass=0.4)))
    hold_slopes_to_differences(plant, track)


@pytest.fixture(scope="module")
def log() -> Recording:
    """Half a second of both drives, without noise."""
    return multisines(FOUR_BAR, period_s=0.5, f_min_hz=2.0, rate_hz=250.0)


@pytest.mark.parametrize(
    ("effect", "axis"),
    [
        ("payload_mass", None),
        ("first_moment_error", "hip"),
        ("first_moment_error", "knee"),
        ("link_inertia_error", "knee"),
    ],
)
def test_columns_are_the_change_of_the_torque_that_is_needed(
    log: Recording, effect: str, axis: str | None
) -> None:
    model = on_drives(FOUR_BAR)
    motion = replay_of(model, [log]).motion(compile_plant(model), 0, log)
    place = Placement.of(model, EffectKey(effect, axis))
    columns = effect_named(effect).response(motion, model, place, {}).columns
    names = [p.name for p in effect_named(effect).parameters if not p.optional]
    track = Track(motion.position, motion.velocity, motion.acceleration)
    for column, name in zip(columns, names, strict=True):
        # from where no mass is taken off
        sizes = [{**dict.fromkeys(names, 0.0), name: h} for h in (2e-5, 1e-5)]
        two, one = (
            required_torque(compile_plant(having(model, EffectKey(effect, axis), **values)), track)
            for values in sizes
        )
        slope = (two - one) / 1e-5
        np.testing.assert_allclose(-column[10:-10], slope[10:-10], atol=2e-3 * np.abs(slope).max())


def test_a_chain_s_masses_are_not_in_the_serial_tree_s_file() -> None:
    wrong = having(FOUR_BAR, EffectKey("first_moment_error", "knee"), along=0.01, across=0.0)
    made = into_file(wrong, FOUR_BAR.serial)
    assert (made.changes, made.written, made.left) == ((), (), wrong.effects)
