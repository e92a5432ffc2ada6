"""The shipped models are found, and whoever asks for another is told which there are."""

from pathlib import Path

import pytest

from workbench.core import InputError
from workbench.core.paths import closed_chain_file, models_folder


def test_the_folder_holds_models_trees_and_closed_chains() -> None:
    folder = models_folder()
    assert (folder / "leg.toml").is_file()
    assert (folder / "serial" / "leg.xml").is_file()
    assert closed_chain_file("leg") == folder / "closed_chain" / "leg.sdf"


def test_an_unknown_chain_is_answered_with_the_known_ones() -> None:
    with pytest.raises(InputError, match=r"arm\.sdf: no such closed chain is shipped; choose one of .*leg"):
        closed_chain_file("arm")


def test_an_installation_without_models_says_where_it_looked(tmp_path: Path) -> None:
    roots = (tmp_path / "_models", tmp_path / "models")
    with pytest.raises(InputError, match="the shipped models are missing; install workbench again"):
        models_folder(roots)
    (tmp_path / "models").mkdir()
    assert models_folder(roots) == tmp_path / "models"
