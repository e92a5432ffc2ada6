"""A table becomes a recording in one call; what is left open is refused with the argument that answers it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import workbench as wb
from workbench.core import InputError

TUTORIAL = Path(__file__).resolve().parents[2] / "docs" / "tutorial"


def test_a_model_and_a_log_make_a_recording() -> None:
    arm = wb.load_model(TUTORIAL / "arm.xml")
    sweep = wb.import_table(TUTORIAL / "sweep.csv", arm)
    assert sweep.axes == arm.axes and sweep.controller.kind == "pd"
    assert np.abs(sweep.position).max() < np.pi, "degrees were read as such"


def test_what_is_left_open_is_refused_by_the_argument_s_name(tmp_path: Path) -> None:
    table = tmp_path / "log.csv"
    rows = "".join(f"{np.sin(k / 9):.5f},{np.cos(k / 9):.5f}\n" for k in range(400))
    table.write_text("q1,tau1\n" + rows)
    with pytest.raises(InputError, match="rate_hz=") as refused:
        wb.import_table(table)
    assert str(table) in str(refused.value)
    assert wb.import_table(table, rate_hz=200.0, likeliest=True).period == pytest.approx(0.005)


def test_tab_offers_the_public_names() -> None:
    assert "import_table" in dir(wb) and "annotations" not in dir(wb)
    assert all(getattr(wb, name) for name in dir(wb))
