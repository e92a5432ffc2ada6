"""Pictures as files: the ending of the name says the format, and the same picture has the same bytes."""

from __future__ import annotations

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from workbench.core import InputError
from workbench.report import save_figure


@pytest.mark.parametrize(
    ("ending", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF"), ("PDF", b"%PDF")]
)
def test_a_picture_has_the_format_of_its_name(ending: str, start: bytes, tmp_path: Path) -> None:
    figure = Figure(figsize=(2, 1))
    figure.add_subplot().plot([0, 1])
    first, again = (save_figure(figure, tmp_path / f"{k}.{ending}").read_bytes() for k in (1, 2))
    assert first.startswith(start) and first == again
    assert b"CreationDate" not in first and b"<dc:date>" not in first


@pytest.mark.parametrize("name", ["a.gif", "a", "a.png.txt"])
def test_no_other_picture_is_written(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"name it \.png, \.svg or \.pdf"):
        save_figure(Figure(), tmp_path / name)
    assert not list(tmp_path.iterdir())
