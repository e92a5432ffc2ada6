"""Names of strangers on the terminal: no markup, no control characters."""

from __future__ import annotations

import io

import pytest
from rich.table import Table
from rich.text import Text

from workbench.cli.common import echo
from workbench.report.layout import Screen, print_table

NASTY = "[red]a[/b] :smile: \x1b[31m\x07\u202e"


def test_tables_show_names_as_they_are() -> None:
    out = io.StringIO()
    table = Table(title=NASTY)
    table.add_column(NASTY)
    table.add_row(NASTY)
    table.add_row(Text(NASTY))
    print_table(table, Screen(file=out, width=80))
    assert out.getvalue().count("[red]a[/b] :smile:") == 4
    assert all(line.isprintable() for line in out.getvalue().split("\n"))


def test_lines_show_names_as_they_are(capsys: pytest.CaptureFixture[str]) -> None:
    echo(f"{NASTY}\nnext")
    first, second, _ = capsys.readouterr().out.split("\n")
    assert first.isprintable() and first.startswith("[red]") and second == "next"
