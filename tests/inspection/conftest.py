"""The sound log, made once."""

import pytest

from tests.inspection.belt import made
from workbench.core import Recording


@pytest.fixture(scope="package")
def sound() -> Recording:
    return made()
