"""A measured drive with a flexible coupling, given to the diagnosis as a rigid shaft."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from tests.data_helpers import two_mass
from workbench.core import Recording
from workbench.diagnosis import improve
from workbench.effects import load_model
from workbench.recordings import load_recording

_INERTIA = 0.01021  # of both, as the lines below 25 Hz have it, per ampere

_RIGID = """<mujoco><worldbody><body><joint name="motor" axis="0 0 1" armature="{half}"/>
<inertial pos="0 0 0" mass="1" diaginertia="{half} {half} {half}"/></body></worldbody></mujoco>"""


def part(recording: Recording, first: int, last: int) -> Recording:
    """Some of its periods of a second."""
    rows = slice(2500 * first, 2500 * last)
    return replace(
        recording, name=f"{first}_{last}", time=recording.time[rows] - recording.time[rows][0],
        signals={name: x[rows] for name, x in recording.signals.items()}, valid=recording.valid[rows],
    )  # fmt: skip


def test_the_coupling_is_named(tmp_path: Path) -> None:
    """It rings where the published response does: dip at 53 Hz, top at 77 Hz (authors' figures)."""
    _, path = two_mass(tmp_path)
    (tmp_path / "shaft.xml").write_text(_RIGID.format(half=0.5 * _INERTIA))
    recording = load_recording(path)
    result, better = improve(
        load_model(str(tmp_path / "shaft.xml")), [part(recording, 1, 6)], [part(recording, 10, 15)]
    )
    first = result.steps[0]
    assert first.key.effect == "joint_compliance" and first.key.axis == "motor"
    assert result.holdout_error_after is not None and result.holdout_error_before is not None
    assert result.holdout_error_after < 0.05 * result.holdout_error_before
    stiffness = next(e for e in better.effects if e.key == first.key).values["stiffness"]
    dip = np.sqrt(stiffness / (0.5 * _INERTIA)) / (2 * np.pi)
    assert abs(dip - 53.0) < 2.0
    assert not any(
        step.key.effect in ("parallel_spring", "encoder_scale", "cogging") for step in result.steps
    )
