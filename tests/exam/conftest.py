"""One case of the open set, made once."""

from pathlib import Path

import pytest
from workbench_exam.plants.write import make, write
from workbench_exam.seal import OPEN_KEY


@pytest.fixture(scope="session")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of case 000, alone in its set."""
    folder = tmp_path_factory.mktemp("cases") / "case-000"
    write(make(60, 0, 0), folder, OPEN_KEY)
    return folder
