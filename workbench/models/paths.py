"""The model file meant by a path or a name, of the shipped models or of two common packages of robots."""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import Any

from workbench.core import InputError
from workbench.core.paths import models_folder

#: What stands before the colon -> the package's name where packages are installed from.
_PACKAGES = {"robot_descriptions": "robot_descriptions", "mujoco_menagerie": "mujoco-menagerie"}


def find_model(path: str | Path) -> Path:
    """Return the file meant by `path`: itself, a shipped model (``leg``), or a packaged robot.

    Raises:
        InputError: there is none; names the shipped models, or what the package of robots lacks.
    """
    given = Path(path)
    if given.is_file():
        return given
    shipped = _shipped(given)
    if shipped is not None:
        return shipped
    packaged = packaged_robot(str(path))
    if packaged is not None:
        return packaged
    names = ", ".join(sorted(p.stem for p in models_folder().glob("*.toml")))
    raise InputError(
        "no such model file", file=path, remedy=f"give a .toml, .xml or .urdf file, or one of {names}"
    )


def is_named_model(name: str) -> bool:
    """Whether a text is a shipped model's name or a packaged robot's, and nothing else here is called so."""
    given = Path(name)
    return not given.exists() and (_shipped(given) is not None or is_packaged(name))


def _shipped(given: Path) -> Path | None:
    """The shipped model of a name; None where there is none."""
    file = models_folder() / f"{given.stem}.toml"
    # a file of one's own that is not there yet must not turn into a shipped model of its name
    name = not given.suffix and given.parent == Path()
    shown = given.suffix in ("", ".toml") and given.parent.name == "models"
    return file if (name or shown) and file.is_file() else None


def is_packaged(name: str) -> bool:
    """Whether a name says which package has the robot."""
    return name.partition(":")[0] in _PACKAGES


def packaged_robot(name: str) -> Path | None:
    """Return the file of a robot from another package, which downloads it at its first use.

    Args:
        name: ``robot_descriptions:ur10e_mj_description`` (its MJCF, else its URDF) or
            ``mujoco_menagerie:universal_robots_ur10e`` (the robot alone, without a floor).

    Returns:
        The ``.xml`` or ``.urdf`` file; None where `name` begins with neither package.

    Raises:
        InputError: the package is not installed, has no such robot, or could not download it.
    """
    package, _, robot = name.partition(":")
    if package not in _PACKAGES:
        return None
    try:
        module = import_module(package)
    except ImportError as error:
        raise InputError(
            f"needs the package {_PACKAGES[package]}", file=name,
            remedy=f"install it: pip install {_PACKAGES[package]}",
        ) from error  # fmt: skip
    menagerie = package == "mujoco_menagerie"
    known = list(module.names() if menagerie else module.DESCRIPTIONS)
    if robot not in known:
        near = get_close_matches(robot, known, n=3, cutoff=0.4)
        remedy = f"did you mean {' or '.join(near)}?" if near else f"it has {', '.join(sorted(known))}"
        raise InputError(f"{package} has no robot '{robot}'", file=name, remedy=remedy)
    try:
        with redirect_stdout(sys.stderr):  # they tell of downloads; a result may stand on standard output
            file = _of_menagerie(module, robot) if menagerie else _of_description(robot)
    except Exception as error:  # git's and the network's errors have no common root
        remedy = f"{package} downloads a robot at its first use: check the network"
        reason = str(error).strip().splitlines()[-1:] or [type(error).__name__]  # git's own line is its last
        raise InputError(f"could not be downloaded: {reason[0]}", file=name, remedy=remedy) from error
    if file is None:
        remedy = "choose another, or write the URDF with xacro and give that file"
        raise InputError("it has neither an MJCF nor a URDF", file=name, remedy=remedy)
    return file


def _of_menagerie(module: Any, robot: str) -> Path:
    found = module.get(robot)
    return Path(found.xml(found.default_model))


def _of_description(robot: str) -> Path | None:
    module = import_module(f"robot_descriptions.{robot}")
    paths = (getattr(module, key, None) for key in ("MJCF_PATH", "URDF_PATH"))
    return next((Path(path) for path in paths if path), None)
