"""The command line as a solver of the exam: what it is given, and how its JSON is read."""

from pathlib import Path

import numpy as np
import pytest
from exam_solver import answer_of, written
from workbench_exam.cases import read_case
from workbench_exam.plants.draw import draw
from workbench_exam.plants.write import write

from workbench.effects import load_model
from workbench.recordings import load_recordings


def finding(effect: str, location: str = "actuator", **parameters: float) -> dict:
    values = {name: {"value": value, "std": 0.1, "unit": ""} for name, value in parameters.items()}
    # what the exam has no word for is no look-alike there
    alike = [{"effect": "payload_mass", "axis": "lift"}, {"effect": "presliding_hysteresis", "axis": "lift"}]
    return {
        "effect": effect,
        "axis": "lift",
        "location": location,
        "parameters": values,
        "probability": 0.9,
        "indistinguishable_from": alike,
    }


def test_findings_are_read_into_the_form() -> None:
    found = [
        finding("first_moment_error", along=0.2, across=0.1),
        finding("asymmetric_friction"),
        finding("coulomb_friction", "joint", torque=1.0),
    ]
    answer = answer_of({"verdict": "missing_effect", "findings": found})
    (named,) = answer.named
    assert (
        named.place == "lift" and named.also == (("payload_mass", None),) and set(named.values) == {"along"}
    )
    assert named.values["along"] == pytest.approx((0.2, 0.004, 0.396), abs=1e-3)
    assert answer.outside == ("asymmetric_friction@lift", "coulomb_friction@lift joint")
    apart = answer_of({"verdict": "consistent", "findings": [], "disagreeing": [{}]})
    assert apart.verdict == "recordings_disagree"


@pytest.mark.parametrize("kind", [("single", 2), ("stranger", 0)], ids=["coupled drives", "positions alone"])
def test_a_case_becomes_a_model_and_recordings(kind: tuple[str, int], tmp_path: Path) -> None:
    write(draw(0, *kind), tmp_path / "case-000", "open")
    case = read_case(tmp_path / "case-000")
    model, files = written(case, tmp_path)
    recordings = load_recordings([str(file) for file in files])
    assert load_model(str(model)).axes == case.drives
    for ours, read in zip(case.recordings, recordings, strict=True):
        assert set(ours.signals) <= set(read.signals)
        np.testing.assert_allclose(read.position, ours.signals["position"], atol=1e-9)
        assert tuple(read.controller.kp) == tuple(case.kp)
