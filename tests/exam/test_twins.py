"""Where a link turns with its rotor, no motion tells their inertias apart, and either name is right."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from workbench_exam.answers import Answer, Named
from workbench_exam.plants.draw import draw
from workbench_exam.plants.files import mjcf
from workbench_exam.plants.machines import MACHINES, draw_machine
from workbench_exam.plants.plant import Plant, play, with_effect
from workbench_exam.plants.write import truth
from workbench_exam.scoring import mark
from workbench_exam.twins import one_body

EXAM = Path(__file__).resolve().parents[2] / "exam"


def apart(plant: Plant, drive: str) -> float:
    """How far the motions of a rotor and of a link are apart that are too heavy by the same number."""
    size = {"inertia": 0.5 * max(link.armature for link in plant.machine.links)}
    rotor, link = (
        play(with_effect(plant, effect, drive, size), 3, 1, 0.5, 2e-3, noisy=False).angle
        for effect in ("reflected_inertia", "link_inertia_error")
    )
    return float(np.abs(rotor - link).max())


@pytest.mark.parametrize("family", ["arm", "six_axis", "quadruped", "geared"])
def test_drives_said_to_be_one_move_as_one_and_no_others_do(family: str, tmp_path: Path) -> None:
    machine = draw_machine(family, 3)
    (tmp_path / "model.xml").write_text(mjcf(machine))
    twins = one_body(tmp_path / "model.xml", machine.axes)
    assert twins[0] == machine.axes[0]
    for drive in machine.axes[:3]:
        assert (apart(Plant(machine), drive) < 1e-9) == (drive in twins), drive


@pytest.mark.parametrize("family", MACHINES)
def test_of_coupled_and_sliding_drives_none_is_said_too_much(family: str, tmp_path: Path) -> None:
    machine = draw_machine(family, 3)
    (tmp_path / "model.xml").write_text(mjcf(machine))
    assert len(one_body(tmp_path / "model.xml", machine.axes)) == (
        1 if machine.couple or len(machine.links) < 2 else 2
    )


def test_either_name_is_right_there() -> None:
    hidden = [{"effect": "reflected_inertia", "place": "lift", "values": {"inertia": 0.1}, "shows": 5.0}]
    told = truth(draw(0, "number", 0)) | {"hidden": hidden, "one_body": ("yaw", "lift")}
    link = Answer("missing_effect", (Named("link_inertia_error", "lift"),))
    assert mark(told, link, 1.0, None)["named"][0]["is"] == "alike" and mark(told, link, 1.0, None)["good"]
    assert not mark(told | {"one_body": ("yaw",)}, link, 1.0, None)["good"]


def test_what_rounding_decides_is_alike_on_every_processor(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(EXAM / "baselines")
    import stepwise

    scores = [(6.0, 0), (5.0 + 1e-7, 1), (5.0, 4), (4.0, 7)]
    assert stepwise.ranked(scores) == [7, 1, 4, 0]
    columns = np.sin(np.arange(50.0))[:, None]
    twin = stepwise.Candidate("reflected_inertia", "lift", columns, lambda x: {})
    other = replace(twin, effect="link_inertia_error", columns=columns * (1.0 + 1e-13))
    y = columns[:, 0] + 1e-3 * np.cos(np.arange(50.0) ** 2)
    for pool in ([twin, other], [other, twin]):
        assert stepwise.goes_with(y, pool) is pool[0]
