"""What `pip install` brings to a robot's own computer: pinned, light to the last, with wheels for aarch64."""

from __future__ import annotations

import ast
import json
import re
import sys
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.tags import parse_tag
from wheels import EXTRA, ROOT, TABLE, closure, plain, supported

from tests.deployment.test_light import ABSENT, light
from tests.test_packaging import DISTRIBUTIONS


def test_all_that_comes_with_the_runner_is_pinned() -> None:
    lines = [line for lock in ROOT.glob("requirements*.lock") for line in lock.read_text().splitlines()]
    pins = {plain(name): version for name, _, version in (line.partition("==") for line in lines) if version}
    assert {name: found.version for name, found in closure(EXTRA).items()} == {
        name: pins.get(name) for name in closure(EXTRA)
    }


def test_nothing_heavy_comes_with_it() -> None:
    heavy = {plain(DISTRIBUTIONS.get(name, name)) for name in ABSENT}
    assert not heavy & set(closure(EXTRA))


def runs(tags: str, python: str) -> bool:
    """Whether a wheel of these tags runs on a Python of an aarch64 system with glibc 2.28."""
    for tag in parse_tag(tags):
        glibc = re.fullmatch(r"manylinux_(\d+)_(\d+)_aarch64", tag.platform)
        here = tag.platform in ("any", "manylinux2014_aarch64")
        here = here or (glibc is not None and (int(glibc[1]), int(glibc[2])) <= (2, 28))
        own = "cp" + python.replace(".", "")
        stable = (
            tag.abi == "abi3" and tag.interpreter[:3] == "cp3" and int(tag.interpreter[3:]) <= int(own[3:])
        )
        if here and (tag.interpreter in (own, "py3", f"py{own[2:]}") or stable):
            return True
    return False


def test_whatever_comes_with_it_has_a_wheel_for_aarch64() -> None:
    table, pythons = json.loads(TABLE.read_text()), supported()
    assert len(pythons) >= 3
    come = {name: found.version for name, found in closure(EXTRA).items()}
    asked = {name: row["version"] for name, row in table.items()}
    assert asked == come, "python benchmarks/wheels.py --write"
    for name, row in table.items():
        for python in pythons:
            assert runs(row["wheels"][python], python), f"{name} for Python {python}"


def test_what_is_compiled_here_is_compiled_there() -> None:
    table = json.loads(TABLE.read_text())
    for name, found in closure(EXTRA).items():
        pure = re.search(r"^Tag: \S+-none-any$", found.read_text("WHEEL") or "", re.MULTILINE)
        assert bool(pure) == all(tags.endswith("-any") for tags in table[name]["wheels"].values()), name


@pytest.mark.parametrize(
    ("tags", "python", "fits"),
    [("cp312-cp312-manylinux_2_28_aarch64", "3.12", True),
     ("cp312-cp312-manylinux_2_28_aarch64", "3.11", False),
     ("cp310-abi3-manylinux2014_aarch64", "3.13", True), ("cp313-abi3-manylinux2014_aarch64", "3.11", False),
     ("cp312-cp312-manylinux_2_34_aarch64", "3.12", False),
     ("cp312-cp312-manylinux_2_28_x86_64", "3.12", False),
     ("py3-none-any", "3.11", True), ("py2-none-any", "3.11", False)],
)  # fmt: skip
def test_a_wheel_of_another_machine_or_python_is_none(tags: str, python: str, fits: bool) -> None:
    assert runs(tags, python) is fits


def test_what_the_runner_imports_only_when_needed_is_there() -> None:
    code = """
import workbench.deployment.deploy, workbench.cli.deploy, workbench.bundle, workbench.can
print("\\n".join(m.__file__ for n, m in sys.modules.items() if n.startswith("workbench") and m))
"""
    files = light(code).stdout.split()
    assert len(files) > 50
    allowed = {plain(Requirement(each).name) for each in EXTRA}
    for file in files:
        for node in ast.walk(ast.parse(Path(file).read_text())):
            named = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                named = [node.module or ""]
            for name in {each.partition(".")[0] for each in named} - sys.stdlib_module_names - {"workbench"}:
                assert plain(DISTRIBUTIONS.get(name, name)) in allowed, f"{file} imports {name}"
