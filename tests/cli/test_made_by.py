from __future__ import annotations

import shlex
import sys
from pathlib import Path

import pytest

from tests.report import build
from tests.report.browser import Page
from workbench.cli.deliver import Outputs, deliver


def test_a_page_s_command_can_be_typed_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    words = ["compare", "my leg.toml", "a'b.toml", "--html", "page.html"]
    monkeypatch.setattr(sys, "argv", ["workbench", *words])
    page = tmp_path / "page.html"
    deliver(build.comparison(0.0), Outputs(html=str(page), quiet=True), files=[], seeds={"noise": 0})
    text = Page(page.read_text()).text
    assert shlex.join(["workbench", *words]) in text and "'my leg.toml'" in text
