"""MJCF text with all digits, and with paths that lead to the same meshes from anywhere."""

from __future__ import annotations

import ctypes
import html
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import mujoco

from workbench.core.files import check_free, read_file, together, write_whole

_DIGITS = 15  # 0.1 is written as 0.1, and reads back to a relative 1e-15


def exact_xml(spec: mujoco.MjSpec) -> str:
    """Return a compiled spec as text with all digits; MuJoCo's writer keeps six: 1e-6 of an inertia."""
    with _digits(_DIGITS):
        return spec.to_xml()


def anchor_assets(spec: mujoco.MjSpec, file: Path) -> None:
    """Make the folders of meshes and textures absolute, where `file` was the spec's own file."""
    folder = file.resolve().parent
    if spec.meshes or spec.hfields or spec.skins:
        spec.meshdir = str(folder / spec.meshdir)
    if any(texture.file or any(texture.cubefiles) for texture in spec.textures):
        spec.texturedir = str(folder / spec.texturedir)


@contextmanager
def _digits(count: int) -> Iterator[None]:
    """Set how many digits MuJoCo's writer gives.

    MuJoCo's library has a function for this, but its Python bindings do not expose it. If the function is
    missing, the text has six digits; callers that need more compare the text with the model.
    """
    found = [p for p in Path(mujoco.__file__).parent.iterdir() if _is_library(p.name)]
    library = ctypes.CDLL(str(found[0])) if found else None
    if library is None or not hasattr(library, "_mjPRIVATE__set_xml_precision"):
        yield
        return
    before = int(library._mjPRIVATE__get_xml_precision())
    library._mjPRIVATE__set_xml_precision(count)
    try:
        yield
    finally:
        library._mjPRIVATE__set_xml_precision(before)


def _is_library(name: str) -> bool:
    return name.startswith(("libmujoco.", "mujoco.")) and any(e in name for e in (".so", ".dylib", ".dll"))


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
    contents = {copy: read_file(source) for copy, source in copies.items()}
    for copy, content in contents.items():
        if not copy.exists() or copy.read_bytes() != content:
            check_free(copy, force=force)
    with together():
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
