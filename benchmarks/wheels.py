"""Asks the package index whether the robot's own computer can install all that the extra `deploy` brings.

    python benchmarks/wheels.py            # prints what there is for aarch64
    python benchmarks/wheels.py --write    # and puts it where a test compares it with the lock files

Whatever index `pip` is configured with is asked, for wheels alone: a package that would have to be compiled
there ends this with exit code 1. Needs the network; the test does not.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
import tomllib
from importlib.metadata import Distribution, distribution
from pathlib import Path

from packaging.requirements import Requirement

from workbench.core.files import write_whole

ROOT = Path(__file__).resolve().parents[1]
TABLE = ROOT / "tests" / "deployment" / "aarch64.json"
EXTRA = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]["deploy"]
PLATFORM = "manylinux_2_28_aarch64"  # of a system of 2018 or later: Debian 10, Ubuntu 20.04, JetPack 5


def plain(name: str) -> str:
    """A package's name as an index compares it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def closure(wanted: list[str]) -> dict[str, Distribution]:
    """Everything that comes with these requirements, by name; extras that nobody asked for do not."""
    found: dict[str, Distribution] = {}
    todo = [Requirement(each) for each in wanted]
    while todo:
        want = todo.pop()
        if plain(want.name) in found:
            continue
        found[plain(want.name)] = distribution(want.name)
        for each in map(Requirement, distribution(want.name).requires or ()):
            extras = want.extras or {""}
            if each.marker is None or any(each.marker.evaluate({"extra": extra}) for extra in extras):
                todo.append(each)
    return found


def wheels() -> dict[str, dict[str, object]]:
    """Name -> version and the file of the wheel for each Python that is supported.

    Raises:
        SystemExit: there is a package without one.
    """
    pins = [f"{plain(name)}=={found.version}" for name, found in sorted(closure(EXTRA).items())]
    table: dict[str, dict[str, object]] = {}
    for python in supported():
        with tempfile.TemporaryDirectory() as folder:
            words = ["install", "--dry-run", "--quiet", "--ignore-installed", "--no-deps", "--report", "-"]
            words += ["--only-binary", ":all:", "--target", folder, "--python-version", python]
            words += ["--platform", PLATFORM, "--platform", "manylinux2014_aarch64", "--platform", "any"]
            done = subprocess.run(
                [sys.executable, "-m", "pip", *words, *pins], capture_output=True, text=True
            )
        if done.returncode:
            raise SystemExit(f"for Python {python}: {done.stderr.strip().splitlines()[-1]}")
        for each in json.loads(done.stdout)["install"]:
            name, version = plain(each["metadata"]["name"]), each["metadata"]["version"]
            row = table.setdefault(name, {"version": version, "wheels": {}})
            file = each["download_info"]["url"].rpartition("/")[2]
            row["wheels"][python] = file.removesuffix(".whl").split("-", 2)[2]  # type: ignore[index]
    return table


def supported() -> list[str]:
    """Versions of Python that the package names."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    words = [line.split(" :: ")[-1] for line in project["classifiers"]]
    return [word for word in words if word.startswith("3.")]


def main() -> None:
    """Prints or writes the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--write", action="store_true", help=f"into {TABLE.name}")
    arguments = parser.parse_args()
    made = json.dumps(wheels(), indent=1, sort_keys=True) + "\n"
    print(made, end="")
    if arguments.write:
        write_whole(TABLE, made, force=True)


if __name__ == "__main__":
    main()
