"""XML from anywhere: no entities, and only files beside or below the document."""

from __future__ import annotations

import re
from pathlib import Path
from typing import cast
from xml.etree import ElementTree

from .errors import InputError

_LARGEST = 64 * 2**20  # bytes; meshes are files of their own
_DEEPEST = 200  # elements in one another; parsers go down recursively


def parse_xml(
    raw: bytes,
    file: Path | None,
    *,
    prefixes: bool = True,
    problem: str = "is no XML",
    remedy: str = "correct what it names",
) -> ElementTree.Element:
    """Return the root of an XML document.

    Args:
        raw: the document.
        file: where it is from, for the error.
        prefixes: whether names keep the prefix of their namespace; without, undeclared ones do no harm.
        problem, remedy: what is said of a document that is no XML.

    Raises:
        InputError: not XML, too large, too deep, or with entities of its own, which may grow without end or
            name other files.
    """
    if len(raw) > _LARGEST:
        raise InputError(f"is larger than {_LARGEST >> 20} MiB", file=file, remedy="give meshes as files")
    if b"\0" in raw:  # two or four bytes a character, in which the next look would find nothing
        raise InputError(f"{problem}: it is not UTF-8", file=file, remedy="save it as UTF-8")
    if b"<!DOCTYPE" in raw or b"<!ENTITY" in raw:
        raise InputError("declares a document type", file=file, remedy="remove <!DOCTYPE> and <!ENTITY>")
    if not prefixes:
        raw = re.sub(rb"<(/?)[\w.-]+:", rb"<\1", raw)
    depth = 0
    parser = ElementTree.XMLPullParser(("start", "end"))
    try:
        parser.feed(raw)
        parser.close()
        root = None
        for step in parser.read_events():
            event, element = cast(tuple[str, ElementTree.Element], step)
            root = element if root is None else root
            depth += 1 if event == "start" else -1
            if depth > _DEEPEST:
                raise InputError(f"nests more than {_DEEPEST} elements", file=file, remedy="write it flat")
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise InputError(f"{problem}: {error}", file=file, remedy=remedy) from error
    if root is None:
        raise InputError(f"{problem}: it has no element", file=file, remedy=remedy)
    return root


def check_inside(
    name: str, folder: Path | None, file: Path | None, key: str, within: Path | None = None
) -> Path:
    """Return a file that another one names, which must lie beside or below that one.

    Args:
        name: as it is written there.
        folder: of the file that names it; None where it may name none.
        file, key: for the error.
        within: a folder that it may lie in instead.

    Raises:
        InputError: it is absolute, goes up, or is a link that leads out.
    """
    remedy = "put it in the folder of the file that names it, or below, and name it relative to that folder"
    if within is not None:
        remedy = "put it in a folder beside or below that of the file, and name it relative to the file"
    if folder is None:
        raise InputError(f"names the file '{name}'", file=file, column=key, remedy="put its content in place")
    if "\0" in name or ":" in name or Path(name).is_absolute():
        raise InputError(
            f"'{name}' is not a path inside the file's folder", file=file, column=key, remedy=remedy
        )
    try:
        target = (folder / name).resolve()
    except (OSError, RuntimeError) as error:
        raise InputError(f"'{name}' cannot be found", file=file, column=key, remedy=remedy) from error
    if not target.is_relative_to((within or folder).resolve()):
        raise InputError(f"'{name}' is outside its folder", file=file, column=key, remedy=remedy)
    return target
