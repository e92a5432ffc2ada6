"""The line that says what to do after an import: one example of each kind, with the number that was found."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from workbench.cli.import_next import next_step
from workbench.inspection.result import Remark

COLUMNS = {"position": ["q1", "q2"], "torque_measured": ["i1", "i2"], "position_reference": ["r1", "r2"]}


def _next(*remarks: Remark) -> str:
    described: dict[str, Any] = {"axes": ["hip", "knee"], "columns": COLUMNS}
    return next_step(described, remarks, Path("run.toml"), None, short=False, looped=True)


def test_a_unit_is_corrected_by_the_factor_that_was_found() -> None:
    torque = [
        Remark(
            "problem", "unit", axis, f"Measured torque of '{axis}' is 1000 times its command.", {"factor": f}
        )
        for axis, f in (("hip", 1000.0), ("knee", 999.7))
    ]
    told = _next(*torque)
    assert told.count("[units]") == 1 and "{column = 'i1', scale = 0.001}" in told
    value = {"signal": "position_reference", "factor": -57.29578}
    reference = Remark("problem", "unit", "knee", "Reference of 'knee' is 57.3 times its position.", value)
    assert "{column = 'r2', scale = 0.01745}" in _next(reference)


def test_every_kind_of_problem_has_its_own_way() -> None:
    sign = Remark("problem", "sign", "knee", "Measured torque of 'knee' has the wrong sign.", {})
    unit = Remark("problem", "unit", "hip", "Velocity of 'hip' is 10 times the derivative.", {})
    told = _next(sign, unit)
    assert "scale = -1.0" in told and "scale = NUMBER" in told and told.index("-1.0") < told.index("NUMBER")
