"""Units come in as people write them; what is no unit of a kind stays out, quickly."""

from __future__ import annotations

import re
import time

import numpy as np
import pytest

from workbench.core.units import is_unit, to_si


@pytest.mark.parametrize(
    ("unit", "kind", "scale", "si"),
    [
        ("deg", "position", np.pi / 180, "rad"),
        ("turn", "position", 2 * np.pi, "rad"),
        ("mm", "position", 1e-3, "m"),
        ("rpm", "velocity", 2 * np.pi / 60, "rad/s"),
        ("rad s^-1", "velocity", 1.0, "rad/s"),
        ("rad·s⁻¹", "velocity", 1.0, "rad/s"),
        ("rad*s**(-1)", "velocity", 1.0, "rad/s"),
        ("mN*m", "torque", 1e-3, "N*m"),
        ("kg*m**2/s**2", "torque", 1.0, "N*m"),
        ("kgf", "force", 9.80665, "N"),
        ("ms", "time", 1e-3, "s"),
        ("-8.7*N*m", "torque", -8.7, "N*m"),
    ],
)
def test_what_people_write(unit: str, kind: str, scale: float, si: str) -> None:
    found = to_si(unit, kind)
    assert found[0] == pytest.approx(scale, rel=1e-12) and found[1:] == (0.0, si)


def test_a_temperature_has_an_offset() -> None:
    scale, offset, si = to_si("degC", "temperature")
    assert (scale, si) == (pytest.approx(1.0), "K") and offset == pytest.approx(273.15)


@pytest.mark.parametrize(
    ("unit", "kind"),
    [
        # pint holds an angle to be a bare number, so that all of these have the dimension of one
        ("count", "position"), ("%", "position"), ("", "position"), ("rad**2", "position"),
        ("Hz", "velocity"), ("1/s", "velocity"), ("N*m/rad", "torque"), ("m/rad", "position"),
        ("s", "position"), ("kg", "torque"), ("-1*s", "time"), ("0*N*m", "torque"),
        ("furlongs_per", "velocity"),
    ],
)  # fmt: skip
def test_what_is_no_unit_of_the_kind(unit: str, kind: str) -> None:
    with pytest.raises(ValueError, match=f"unit '{re.escape(unit)}'"):
        to_si(unit, kind)


@pytest.mark.parametrize(
    "unit", ["9**9**9**9", "rad*(9**9*1)**(9**9*1)", "9⁹⁹⁹⁹⁹⁹⁹⁹", "rad^99999999999", "m" * 100_000]
)
def test_a_unit_that_would_take_hours_is_refused_at_once(unit: str) -> None:
    began = time.process_time()
    with pytest.raises(ValueError, match="unknown unit") as refused:
        to_si(unit, "position")
    assert time.process_time() - began < 1.0 and len(str(refused.value)) < 100


@pytest.mark.parametrize(
    ("unit", "wanted", "same"),
    [
        ("N m", "N*m", True), ("N*m*s/rad", "N*m/(rad/s)", True), ("kg*m**2", "kg*m^2", True),
        ("", "1", True), ("mN*m", "N*m", False), ("furlong", "N*m", False), ("deg", "rad", False),
        ("no unit", "rad", False), ("9**9**9**9", "rad", False),
    ],
)  # fmt: skip
def test_a_unit_in_other_words_is_the_same(unit: str, wanted: str, same: bool) -> None:
    assert is_unit(unit, wanted) is same
