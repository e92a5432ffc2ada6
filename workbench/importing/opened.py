"""A user's file as one that the mechanism's parser reads."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from workbench.core import InputError, SimulationError
from workbench.core.xml import parse_xml

from .converted import Converted
from .from_mjcf import convert
from .loop_list import loop_list, with_list


def is_mjcf(file: Path) -> bool:
    """Return whether a file is an MJCF, by its root.

    Raises:
        InputError: it is no XML.
    """
    if not file.is_file():
        return False  # said where it is opened
    raw, remedy = file.read_bytes(), "give an SDF or URDF file, or an MJCF"
    return parse_xml(raw, file, prefixes=False, problem="not an XML file", remedy=remedy).tag == "mujoco"


@contextmanager
def opened(file: Path) -> Iterator[tuple[Path, Converted | None]]:
    """Return a file that the mechanism's parser reads: itself, or while this lasts one made of it that is.

    Raises:
        InputError: it cannot be read or converted; whatever is raised inside names the file itself.
    """
    listed = None if is_mjcf(file) else loop_list(file)
    if listed is None and not is_mjcf(file):
        yield file, None
        return
    converted = convert(file) if listed is None else with_list(file, listed)
    with TemporaryDirectory() as folder:
        sdf = Path(folder) / f"{file.stem}{converted.suffix}"
        sdf.write_text(converted.text)
        try:
            yield sdf, converted
        except InputError as error:
            if error.file is None or Path(error.file).resolve() != sdf.resolve():
                raise
            raise InputError(
                error.problem, file=file, column=error.column, row=error.row, remedy=error.remedy
            ) from error
        except SimulationError as error:
            raise SimulationError(str(error).replace(str(sdf), str(file))) from error
