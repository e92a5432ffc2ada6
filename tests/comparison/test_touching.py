"""Which contacts a model has at the measured poses, over the layouts that legged robots come in."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from workbench.comparison import compare, matched, noise_rules, told
from workbench.comparison.touching import contact_notes
from workbench.core import Controller, InputError, Recording, SimulationError
from workbench.effects import compile_plant, load_model
from workbench.models import Model

_LEG = """<body name="hip" pos="0 0.1 0"><joint name="hip" axis="1 0 0"/>
<geom {hip} type="capsule" size="0.05 0.03" quat="1 1 0 0" mass="0.6"/>
<body name="thigh" pos="0 0.1 0"><joint name="thigh" axis="0 1 0"/>
<geom name="thigh" type="capsule" fromto="0 0 -0.05 0 0 -0.2" size="{thick}" mass="1"/>
<body name="calf" pos="0 0 -0.25"><joint name="calf" axis="0 1 0"/>
<geom name="calf" type="capsule" fromto="0 0 -0.05 0 0 -0.2" size="0.02" mass="0.3"/>
<geom name="foot" type="sphere" size="0.02" pos="0 0 -0.23" mass="0.05"/></body></body></body>"""
_TRUNK = '<geom name="trunk" type="box" size="0.2 0.08 0.06" mass="6"/>'


def _robot(
    folder: Path,
    *,
    base: str = "{trunk}{leg}",
    hip: str = "",
    thick: float = 0.03,
    rest: str = "",
    world: str = "",
) -> Model:
    leg = _LEG.format(hip=hip or 'name="hip"', thick=thick)
    body = '<body name="base" pos="0 0 0.6">' + base.format(trunk=_TRUNK, leg=leg) + "</body>"
    file = folder / "robot.xml"
    file.write_text(f"<mujoco><worldbody>{world}{body}</worldbody>{rest}</mujoco>")
    return load_model(file)


def _pairs(model: Model, posture: tuple[float, ...] = (0.0, 0.0, 0.0)) -> set[frozenset[str]]:
    """Bodies that touch in the simulated model."""
    m = compile_plant(model).mujoco
    data = mujoco.MjData(m)
    for name, q in zip(("hip", "thigh", "calf"), posture, strict=True):
        data.qpos[m.joint(name).qposadr[0]] = q
    mujoco.mj_forward(m, data)
    return {frozenset(m.body(m.geom_bodyid[g]).name for g in (c.geom1, c.geom2)) for c in data.contact}


def _swings(model: Model, low: float = -0.3, high: float = 0.3) -> Recording:
    """All joints go to and fro between two angles, held by a loop."""
    time = 0.002 * np.arange(1500)
    turn = low + (high - low) * 0.5 * (1 - np.cos(4.0 * time))[:, None] * np.ones(3)
    noise = 1e-4 * np.random.default_rng(3).standard_normal((len(time), 6))
    signals = {
        "position": turn + noise[:, :3], "velocity": np.gradient(turn, 0.002, axis=0) + noise[:, 3:],
        "position_reference": turn,
    }  # fmt: skip
    loop = Controller(kind="pd", coordinates="joint", kp=(60.0,) * 3, kd=(2.0,) * 3, period_s=0.002)
    return Recording("swings", model.axes, "joint", time, signals, ("rad",) * 3, controller=loop)


@pytest.mark.parametrize(
    "base",
    [
        "{trunk}{leg}",  # the base's freejoint taken out
        '<body name="plate">{trunk}</body>{leg}',  # its shape on a body that is fixed to it
        "{trunk}<body>{leg}</body>",  # the leg on a flange without a name
    ],
)
def test_what_hangs_on_a_fixed_base_does_not_touch_it(tmp_path: Path, base: str) -> None:
    model = _robot(tmp_path, base=base)
    assert not _pairs(model)
    (note,) = contact_notes(model, [_swings(model)])
    assert "left out" in note and "hip" in note and "thigh" not in note


def test_a_free_base_is_as_mujoco_has_it(tmp_path: Path) -> None:
    assert not _pairs(_robot(tmp_path, base="<freejoint/>{trunk}{leg}"))


@pytest.mark.parametrize(
    "change",
    [
        {"hip": 'contype="0" conaffinity="0"'},
        {"rest": '<contact><exclude body1="base" body2="hip"/></contact>'},
    ],
)
def test_nothing_is_said_where_the_file_says_it_itself(tmp_path: Path, change: dict[str, Any]) -> None:
    model = _robot(tmp_path, **change)
    assert not _pairs(model) and contact_notes(model, [_swings(model)]) == ()


def test_a_pair_that_the_file_names_stays(tmp_path: Path) -> None:
    model = _robot(tmp_path, rest='<contact><pair geom1="trunk" geom2="hip"/></contact>')
    assert _pairs(model) == {frozenset(("base", "hip"))}


@pytest.mark.parametrize(
    "world",
    [
        '<geom name="floor" type="plane" size="1 1 0.1" pos="0 0 0.105"/>',
        '<body name="box" pos="0 0.2 0"><geom type="box" size="0.2 0.2 0.105"/></body>',
    ],
)
def test_a_foot_on_the_floor_of_a_test_stand_still_stands(tmp_path: Path, world: str) -> None:
    model = _robot(tmp_path, world=world)
    (pair,) = _pairs(model)
    assert "calf" in pair
    notes = contact_notes(model, [_swings(model)])
    assert any("touch at" in note and "calf" in note for note in notes)
    assert matched(model, [_swings(model, 0.0, 0.001)])  # the world may press on the machine all the time


def test_links_that_always_overlap_are_refused_by_name(tmp_path: Path) -> None:
    model = _robot(tmp_path, thick=0.13)
    with pytest.raises(InputError, match=r"'base' and 'thigh'.*<exclude body1=\"base\" body2=\"thigh\"/>"):
        compare(model, [_swings(model)])
    apart = _robot(tmp_path, thick=0.13, rest='<contact><exclude body1="base" body2="thigh"/></contact>')
    assert matched(apart, [_swings(apart)])


def test_a_contact_that_comes_and_goes_is_one_of_the_machine(tmp_path: Path) -> None:
    model = _robot(tmp_path, thick=0.06)
    notes = contact_notes(model, [_swings(model, 0.0, 2.5)])
    shares = [int(note.split(" % ")[0].split()[-1]) for note in notes if "touch at" in note]
    assert shares and all(0 < share < 100 for share in shares)
    assert matched(model, [_swings(model, 0.0, 2.5)])


def test_a_floor_that_is_as_large_as_the_signal_is_no_verdict(tmp_path: Path) -> None:
    model = _robot(tmp_path)
    moves, rests = _swings(model), _swings(model, 0.0, 0.0)
    result = compare(model, [moves])
    assert result.noise_error < 0.1 and told(result) is result
    with pytest.raises(SimulationError, match=r"noise alone makes its error 1\.28 times"):
        told(replace(result, noise_error=1.28, noise_error_std=0.02))
    # what only noise moves leaves a perfect model about 1, and a run from a noisy state more
    assert not noise_rules(0.9, [moves]) and noise_rules(1.2, [moves])
    assert not noise_rules(1.4, [rests]) and noise_rules(1.8, [rests])
