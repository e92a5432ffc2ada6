"""A load that a servo counts either side of zero, and a log has without its sign, has its sign again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from workbench.proposing import Table, propose
from workbench.proposing.signed import signed_counts

T = np.arange(400) * 0.01
LOAD = np.round(300.0 * np.sin(3.0 * T) + 20.0)


def table(**columns: np.ndarray) -> Table:
    return Table(Path("log.csv"), columns, plain=True)


@pytest.mark.parametrize("bits", [16, 32])
def test_the_sign_comes_back_and_it_is_said(bits: int) -> None:
    gap = np.where(np.arange(400) == 7, np.nan, LOAD % 2**bits)
    found = signed_counts(table(load=gap))
    np.testing.assert_array_equal(found.columns["load"][8:], LOAD[8:])
    assert np.isnan(found.columns["load"][7]) and not found.plain
    (note,) = found.notes
    assert note.startswith(
        f"'load' jumps by nearly {2**bits} around zero: it is a signed number of {bits} bits"
    )


@pytest.mark.parametrize(
    "values",
    [
        (4000.0 * np.arange(400)) % 65536,  # an encoder that turns on
        (1000.0 * np.arange(400) + 2.0**32 - 3e5) % 2**32,  # a counter that begins anew
        np.where(np.arange(400) % 50 == 0, 65535.0, np.abs(LOAD)),  # a mark of what was not measured
        LOAD,
        LOAD % 65536 + 0.5,
        np.abs(LOAD),
        np.full(400, np.nan),
    ],
)
def test_other_numbers_stay(values: np.ndarray) -> None:
    before = table(load=values)
    assert signed_counts(before) is before


def test_an_import_says_so(tmp_path: Path) -> None:
    position = 0.4 * np.sin(3.0 * T)
    file = tmp_path / "log.csv"
    columns = {"time": T, "position": position, "velocity": 1.2 * np.cos(3.0 * T), "load": LOAD % 65536}
    made = propose(Table(file, columns, plain=True))
    assert made.data is not None and made.data["load"].min() == LOAD.min()
    assert any("written without its sign" in note for note in made.notes)
