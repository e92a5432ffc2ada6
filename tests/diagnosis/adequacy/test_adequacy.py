"""What is certain beside something unknown: laws on joints built alike, with a stranger on one of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import AXES, FAST, SLOW, logged
from workbench.core import Diagnosis
from workbench.diagnosis import diagnose
from workbench.effects import load_model

_LINK = """<body name="{name}_link" pos="0 {place} 0">
 <joint name="{name}" axis="0 1 0" armature="0.08" damping="{damping}"/>
 <inertial pos="0.1 0 0" mass="1" diaginertia="0.002 0.01 0.01"/></body>"""


def pendulums(folder: Path, name: str, damping: float) -> Path:
    """Three that are alike, side by side."""
    links = "".join(_LINK.format(name=a, place=k, damping=damping) for k, a in enumerate(AXES))
    motors = "".join(f'<motor joint="{a}"/>' for a in AXES)
    file = folder / f"{name}.xml"
    world = f"<worldbody>{links}</worldbody><actuator>{motors}</actuator>"
    file.write_text(f'<mujoco><compiler angle="radian"/>{world}</mujoco>')
    return file


def told(
    folder: Path, stranger: Callable[[float, float], float], damping: float = 1.2, motions=(SLOW, FAST)
) -> Diagnosis:
    """Damping is 0.5 on all, larger in the model; what resists the first one besides is in no catalogue."""
    machine = pendulums(folder, "machine", 0.5)

    def resisting(q: np.ndarray, w: np.ndarray) -> np.ndarray:
        return np.array([stranger(q[0], w[0]), 0.0, 0.0])

    logs = [
        logged(machine, tones, seconds=5.0, seed=k, resisting=resisting) for k, tones in enumerate(motions)
    ]
    return diagnose(load_model(pendulums(folder, "model", damping)), logs)


def test_three_that_are_alike_have_one_size(tmp_path: Path) -> None:
    found = told(tmp_path, lambda q, w: 0.0)
    sizes = {str(f.key): f.parameters["damping"].value for f in found.findings}
    assert sizes == {f"viscous_damping@{a}": pytest.approx(-0.7, abs=0.005) for a in AXES}
    assert len(set(sizes.values())) == 1


def test_what_is_strange_on_one_does_not_hide_what_all_have(tmp_path: Path) -> None:
    found = told(tmp_path, lambda q, w: -0.15 * w**2)
    assert {str(f.key) for f in found.findings} == {f"viscous_damping@{a}" for a in AXES}
    for finding in found.findings:
        change = finding.parameters["damping"]
        assert change.value == pytest.approx(-0.7, abs=1.96 * change.std + 0.01)


@pytest.mark.parametrize(("size", "named"), [(0.3, True), (0.45, False)])
def test_a_stranger_that_changes_a_law_s_size_takes_its_name(
    tmp_path: Path, size: float, named: bool
) -> None:
    """Where the law still explains nine tenths of what any curve does, its interval covers the truth."""
    found = told(tmp_path, lambda q, w: -size * np.sin(9.0 * q) * w * abs(w))
    assert found.verdict == "partly_explained"
    assert {str(f.key) for f in found.findings} == {f"viscous_damping@{a}" for a in AXES[not named :]}
    for finding in found.findings:
        change = finding.parameters["damping"]
        assert change.value == pytest.approx(-0.7, abs=1.96 * change.std)
        assert str(finding.key) == "viscous_damping@yaw" or change.value == pytest.approx(-0.7, rel=0.02)


def test_a_model_s_own_damping_is_no_load(tmp_path: Path) -> None:
    """Of slow motion twenty times too much of it is nearly all torque that the model needs.

    A free curve over that must not take its place, or its interval would be three times as wide.
    """
    found = told(tmp_path, lambda q, w: -0.15 * w**2, damping=10.0, motions=(SLOW, SLOW))
    (change,) = (f.parameters["damping"] for f in found.findings if str(f.key) == "viscous_damping@yaw")
    assert change.value == pytest.approx(-9.5, abs=0.07)
    assert change.std < 0.12
