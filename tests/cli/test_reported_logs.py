"""Logs as people handed them in, from import to diagnosis: what is wrong with each is named."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.here import run
from tests.data_helpers import report_folder


def imported(folder: Path, log: Path, *more: object, code: int = 0) -> str:
    """What the import of a log says, as one line of words."""
    done = run("import", log, "-o", folder / f"{log.name.split('.')[0]}.toml", *more, columns=200)
    assert done.returncode == code, done.stdout + done.stderr
    return " ".join((done.stdout + done.stderr).split())


@pytest.mark.parametrize(
    ("pair", "named"),
    [
        ("a b", "all columns of 'hip' or all columns of 'knee'; the data cannot tell which"),
        ("ao bo", "torque of 'knee'"),
        ("am bm", "position and velocity of 'knee'"),
    ],
)
def test_signs(tmp_path: Path, pair: str, named: str) -> None:
    logs = report_folder("signs")
    for name in pair.split():
        said = imported(tmp_path, logs / f"{name}.csv.gz", "--model", logs / "leg.xml")
        assert named in said and "Next: turn what counts the other way" in said
    first, second = (tmp_path / f"{name}.toml" for name in pair.split())
    told = run("diagnose", logs / "leg.xml", first, "--holdout", second, cwd=tmp_path)
    assert told.returncode == 2 and named in told.stderr
