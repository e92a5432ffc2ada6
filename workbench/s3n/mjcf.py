"""MJCF text with all digits, and with paths that lead to the same meshes from anywhere."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import mujoco

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
