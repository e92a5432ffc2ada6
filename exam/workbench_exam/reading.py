"""JSON files, with their name in what is said of a wrong one."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any


def read_json(file: Path) -> Any:
    """What a JSON file holds.

    Raises:
        ValueError: it is no JSON; with its name.
    """
    try:
        return json.loads(file.read_text("utf-8"))
    except ValueError as error:
        raise ValueError(f"{file}: no JSON: {error}") from error
