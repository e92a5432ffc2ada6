"""Reading models: a TOML file, or an MJCF or URDF alone."""

from __future__ import annotations

import tomllib
from pathlib import Path

from pydantic import ValidationError

from workbench.core import InputError
from workbench.core.files import check_format
from workbench.core.grammar import explained
from workbench.core.unfinished import finish

from .from_table import from_table
from .model import Model
from .paths import find_model
from .schema import ModelTable
from .urdf import is_urdf


def read_model(path: str | Path) -> Model:
    """Read a model from a TOML file, or from an MJCF or URDF with identity transmission and no drives.

    Args:
        path: a ``.toml``, ``.xml`` or ``.urdf`` file, or the name of a shipped model or a packaged robot
            (``robot_descriptions:ur10e_mj_description``, ``mujoco_menagerie:universal_robots_ur10e``).

    Raises:
        InputError: anything wrong with the file; one line with the key and the remedy.
    """
    finish(Path(path).parent)
    file = find_model(path)
    if file.suffix == ".xml" or is_urdf(file):
        return from_table(ModelTable(format=1, name=file.stem, serial=file.name), file)
    try:
        raw = tomllib.loads(file.read_text(encoding="utf-8-sig"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"not a TOML file: {error}", file=file, remedy="correct the syntax") from error
    check_format(raw, 1, file)
    if "table" in raw and "serial" not in raw:
        raise InputError(
            "is a recording, not a model", file=file, remedy="the model comes first: MODEL REC..."
        )
    try:
        table = ModelTable.model_validate(raw)
    except ValidationError as error:
        raise explained(error, ModelTable, raw, file) from error
    return from_table(table, file)
