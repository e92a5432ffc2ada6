"""Limits on MJCF files: no plugin; files beside or below them, meshes also in a folder beside theirs."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from workbench.core import InputError
from workbench.core.files import read_file
from workbench.core.xml import check_inside, parse_xml

_FOLDERS = "meshdir", "texturedir", "assetdir"
_MOST = 100  # files that include each other
_LARGEST = 256 * 2**20  # bytes of an asset


def check_mjcf(file: Path, within: frozenset[Path] = frozenset()) -> list[Path]:
    """Check an MJCF file and all files it includes, before MuJoCo reads it.

    Args:
        file: the MJCF.
        within: files that it is attached to, as a model of its own.

    Returns:
        The files that MuJoCo reads, each once, this one first: then those it includes, then meshes, height
        fields and textures, by the paths that they are named by. Of an asset that lies in several of the
        folders that may be meant, all.

    Raises:
        InputError: it is no XML, has a plugin, or names a file outside of its folder, or one that includes
            itself.
    """
    folder, seen, left, read = file.parent, set(within), [file], [file]
    roots: list[tuple[Path, ElementTree.Element]] = []
    while left:
        each = left.pop()
        if each in seen or len(seen) > _MOST:
            raise InputError("is included by itself", file=each, remedy="include each file once")
        seen.add(each)
        raw = read_file(each)
        roots.append((each, parse_xml(raw, each, problem="MuJoCo cannot read this MJCF")))
        for node in roots[-1][1].iter("include"):
            left.append(check_inside(node.get("file", ""), folder, each, "include"))
            read.append(folder / node.get("file", ""))
        for node in roots[-1][1].iter("model"):
            child = check_inside(node.get("file", ""), folder, each, "file")
            read += check_mjcf(child, frozenset(seen))
    # packages of robots have their meshes in a folder beside that of the file
    folders, package = [folder], folder.resolve().parent
    for each, root in roots:
        for node in root.iter():
            _refuse_plugin(node, each)
            named = {k: node.get(k, "") for k in _FOLDERS if node.get(k)}
            folders += [check_inside(name, folder, each, k, package) for k, name in named.items()]
    for each, root in roots:
        for node in root.iter():
            for key, name in node.attrib.items():
                if key.startswith("file") and node.tag not in ("include", "model"):
                    read += _check_asset(name, key, folders, each, package)
    return list(dict.fromkeys(read))


def check_mjcf_text(text: str, file: Path | None) -> None:
    """Check MJCF text without a folder, which may not name any file.

    Raises:
        InputError: it is no XML, has a plugin, or names a file.
    """
    for node in parse_xml(text.encode(), file).iter():
        _refuse_plugin(node, file)
        for key, name in node.attrib.items():
            if key.startswith("file") or node.tag == "include":
                check_inside(name, None, file, key)


def _refuse_plugin(node: ElementTree.Element, file: Path | None) -> None:
    if node.tag in ("extension", "plugin") or "plugin" in node.attrib:
        raise InputError("it has a plugin", file=file, column=node.tag, remedy="describe bodies alone")


def _check_asset(name: str, key: str, folders: list[Path], file: Path, package: Path) -> list[Path]:
    """Return the files that may be meant; MuJoCo drops a path's folders if the file says so."""
    found = []
    for base in folders:
        for each in (name, Path(name).name):
            check_inside(each, base, file, key, package)
            if not (base / each).is_file():
                continue
            if (base / each).stat().st_size > _LARGEST:
                problem = f"'{each}' is larger than {_LARGEST >> 20} MiB"
                raise InputError(problem, file=file, column=key, remedy="simplify the mesh")
            found.append(base / each)
    return found
