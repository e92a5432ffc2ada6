"""Meshes and textures of a written MJCF: named from where the file lies, or copied to where it lies."""

from __future__ import annotations

import html
import re
from collections.abc import Mapping
from pathlib import Path

import mujoco

from workbench.core import InputError
from workbench.core.files import check_free, write_whole


def write_with_assets(xml: str, path: str | Path, *, force: bool = False) -> tuple[Path, tuple[Path, ...]]:
    """Write an MJCF together with its meshes and textures, and return its path and those of the copied files.

    Assets beside or below the new file are named from there; others are copied into a folder beside it.

    Returns:
        The file, and the copies.

    Raises:
        InputError: the file or another copy exists and `force` is not set, or cannot be written.
    """
    target = Path(path)
    check_free(target, force=force)
    text, copies = _placed(xml, target)
    contents = {copy: _content(source) for copy, source in copies.items()}
    for copy, content in contents.items():
        if not copy.exists() or copy.read_bytes() != content:
            check_free(copy, force=force)
    for copy, content in contents.items():
        write_whole(copy, content, force=True)
    return write_whole(target, text, force=force), tuple(contents)


def _placed(xml: str, target: Path) -> tuple[str, dict[Path, Path]]:
    """Return the text with folders relative to the new file, and what to copy: new path -> old path."""
    spec = mujoco.MjSpec.from_string(xml)
    drawn = [asset.file for asset in (*spec.meshes, *spec.hfields, *spec.skins)]
    painted = [name for asset in spec.textures for name in (asset.file, *asset.cubefiles)]
    folders, copies = dict[str, str](), dict[Path, Path]()
    for key, names in (("meshdir", drawn), ("texturedir", painted)):
        files, base = sorted({name for name in names if name}), Path(getattr(spec, key))
        if not files:
            continue
        below = target.resolve().parent
        if base.is_relative_to(below):
            folders[key] = base.relative_to(below).as_posix()
            continue
        folders[key] = f"{target.stem}_assets"
        copies |= {target.parent / folders[key] / name: base / name for name in files}
    return _with_folders(xml, folders), copies


def _with_folders(xml: str, folders: Mapping[str, str]) -> str:
    def said(found: re.Match[str]) -> str:
        bare = re.sub(r' (?:meshdir|texturedir|assetdir)="[^"]*"', "", found[0])
        new = "".join(f' {key}="{html.escape(name)}"' for key, name in folders.items() if name != ".")
        return bare.replace("<compiler", f"<compiler{new}", 1)

    return re.sub(r"<compiler[^>]*>", said, xml, count=1)


def _content(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot be read ({reason})", file=file, remedy="check the path") from error
