"""All files of a command, or none: a fault takes back what was written, the answer "no" does not."""

from __future__ import annotations

from pathlib import Path

import pytest
import typer

from workbench.cli.app import app
from workbench.cli.common import whole
from workbench.core import InputError
from workbench.core.files import write_whole


@pytest.mark.parametrize("ending", [typer.Exit(1), typer.Exit(0), None])
def test_an_answer_leaves_its_files(tmp_path: Path, ending: typer.Exit | None) -> None:
    def command(name: str) -> None:
        write_whole(tmp_path / name, "1")
        assert not (tmp_path / name).exists()
        if ending is not None:
            raise ending

    try:
        whole(command)(name="a.json")
    except typer.Exit as code:
        assert code is ending
    assert (tmp_path / "a.json").read_text() == "1"


@pytest.mark.parametrize("fault", [InputError("wrong"), KeyboardInterrupt(), MemoryError()])
def test_a_fault_leaves_nothing(tmp_path: Path, fault: BaseException) -> None:
    def command() -> None:
        write_whole(tmp_path / "a.json", "1")
        raise fault

    with pytest.raises(type(fault)):
        whole(command)()
    assert list(tmp_path.iterdir()) == []


def test_commands_that_only_write_their_results_are_whole() -> None:
    plain = {info.callback.__name__ for info in app.registered_commands if info.callback and not _held(info)}
    assert plain == {"demo", "deploy", "export", "fleet", "import_", "improve", "record", "train", "ui"}


def _held(info: typer.models.CommandInfo) -> bool:
    return hasattr(info.callback, "__wrapped__")
