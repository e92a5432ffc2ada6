"""The page of ``frf``: on virtual hardware the closed chain is right, and Kin-Only is not."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.models import read_model
from workbench.recordings import load_recording
from workbench.report import render_sheet
from workbench.report.response import words_of
from workbench.rigs import VirtualLeg, multisine
from workbench.verification import FrfComparison, compare_frf, frf_sheet

from ..data_helpers import two_mass


@pytest.fixture(scope="module")
def found() -> list[FrfComparison]:
    experiments = [multisine(m, duration=16.0, f_max=50.0) for m in ("sum", "difference")]
    return compare_frf(read_model("leg"), VirtualLeg(seed=1).run(experiments))


def test_it_holds_every_model_beside_the_measurement(found: list[FrfComparison]) -> None:
    sheet = frf_sheet("leg", found)
    drawn = [s for s in sheet.sections if s.drawings]
    assert len(drawn) == 1 and len(drawn[0].drawings[0].panels) == 5  # four entries, and all together
    names = {c.name for p in drawn[0].drawings[0].panels for r in p.rows for c in r.curves}
    assert {"measured", "uncertainty", "closed chain", "Kin-Only", "S3N-Act", "S3N-Full", "exact"} <= names
    table = sheet.sections[0].tables[0]
    assert [row[0] for row in table.rows] == [words_of(name) for name in found[0].models]
    assert "Of the serial trees, exact" in sheet.sentence and "Kin-Only by" in sheet.sentence
    assert "frequency responses of leg" in render_sheet(sheet, command="workbench frf leg").lower()


def test_a_shell_prints_a_line_per_model_and_per_entry(found: list[FrfComparison]) -> None:
    words = repr(found[0])
    assert "beside 5 models" in words and "Kin-Only" in words and words.count("\n") < 10
    response = repr(found[0].frf)
    assert "hip over knee" in response and "rad/s / (N m)" in response and response.count("\n") < 10
    for value in (found[0], found[0].frf):
        assert "array(" not in repr(value) and value._repr_html_().startswith("<div>")
        assert value.plot().axes[0].get_ylabel().startswith("magnitude")


def test_the_verdict_follows_the_numbers(found: list[FrfComparison]) -> None:
    c = found[0]
    true = {**c.error, "closed_chain": c.noise}
    right = frf_sheet("leg", [replace(c, error=true)])
    assert right.tone == "consistent" and "within the measurement's uncertainty" in right.sentence
    near = frf_sheet("leg", [replace(c, error={**c.error, "closed_chain": 1.4 * c.noise})])
    assert near.tone == "consistent" and "within" not in near.sentence
    assert "agrees" in near.sentence and "1.4 times the measurement's uncertainty" in near.sentence
    wrong = frf_sheet("leg", [replace(c, error={**c.error, "closed_chain": 4.0 * c.noise})])
    assert wrong.tone == "missing_effect" and "4.0 times the measurement's uncertainty" in wrong.sentence


def test_a_model_without_a_chain_is_judged_by_its_best_tree(found: list[FrfComparison]) -> None:
    c = found[0]
    bare = replace(
        c,
        models={k: v for k, v in c.models.items() if k in ("kin_only", "s3n_act")},
        error={k: v for k, v in c.error.items() if k in ("kin_only", "s3n_act")},
    )
    assert frf_sheet("leg", [bare]).sentence.startswith("S3N-Act misses")


def test_many_postures_draw_the_worst(found: list[FrfComparison]) -> None:
    c = found[0]
    many = [
        replace(c, error={k: (1 + 0.1 * i) * e for k, e in c.error.items()}, noise=np.array(c.noise))
        for i in range(9)
    ]
    sheet = frf_sheet("leg", many)
    assert sum(bool(s.drawings) for s in sheet.sections) == 6
    assert len(sheet.sections[0].tables[0].rows) == 9 * len(c.models)
    assert any("6 postures" in line for line in sheet.lines)


def test_a_measured_coupling_refuses_a_rigid_tree(tmp_path: Path) -> None:
    """Anti-resonance at 53 Hz, resonance at 77 Hz: there the rigid model is furthest off."""
    model, recording = two_mass(tmp_path)
    (found,) = compare_frf(read_model(model), [load_recording(recording)])
    name = next(iter(found.models))
    assert found.overall(name) > 10 * found.overall_noise
    assert 48.0 < found.worst(name) < 85.0
    sheet = frf_sheet("rigid", [found])
    assert sheet.tone == "missing_effect" and f"{found.worst(name):.3g} Hz" in sheet.lines[0]
