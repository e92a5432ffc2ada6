"""The page of benchmarks: each part has its place, and writing one leaves the others alone."""

from __future__ import annotations

import all as every
import pytest
from ratios.row import Part, Row, table


@pytest.mark.parametrize("name", every.PARTS)
def test_a_part_is_written_between_its_marks(name: str) -> None:
    page = every.PAGE.read_text(encoding="utf-8")
    part = every.PARTS[name]
    start, end = every.marks(part)
    new = every.replaced(page, part, table([Row("this", "that", "0.5 (0.4 to 0.6, 3 times)")]))
    assert "| this | that | 0.5 (0.4 to 0.6, 3 times) |" in new
    assert new.partition(start)[0] == page.partition(start)[0]
    assert new.partition(end)[2] == page.partition(end)[2]
    assert every.replaced(new, part, "") == every.replaced(page, part, "")


def test_what_is_not_installed_keeps_its_figures(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def missing(quick: bool) -> list[Row]:
        raise ImportError("no such toolbox")

    before = every.PAGE.read_text(encoding="utf-8")
    monkeypatch.setitem(every.PARTS, "sysid", Part("sysid", "title", "about", missing))
    monkeypatch.setattr("sys.argv", ["all.py", "--only", "sysid"])
    every.main()
    assert "left out: no such toolbox" in capsys.readouterr().out
    assert every.PAGE.read_text(encoding="utf-8") == before
