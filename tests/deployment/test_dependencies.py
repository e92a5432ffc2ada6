"""What `pip install` brings to a robot's own computer: pinned, light to the last, with wheels for aarch64."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from importlib.metadata import Distribution, distribution
from pathlib import Path

from packaging.requirements import Requirement

from tests.deployment.test_light import ABSENT, ROOT, light
from tests.test_packaging import DISTRIBUTIONS

EXTRA = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]["deploy"]
#: Compiled ones. Each has manylinux wheels for aarch64 on PyPI; whoever adds one looks for them there first.
COMPILED = {"ml-dtypes", "numpy", "onnx", "onnxruntime", "protobuf", "pydantic-core", "wrapt"}


def plain(name: str) -> str:
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


def test_all_that_comes_with_the_runner_is_pinned_as_it_was_tested() -> None:
    lines = [line for lock in ROOT.glob("requirements*.lock") for line in lock.read_text().splitlines()]
    pins = {plain(name): version for name, _, version in (line.partition("==") for line in lines) if version}
    assert {name: found.version for name, found in closure(EXTRA).items()} == {
        name: pins.get(name) for name in closure(EXTRA)
    }


def test_nothing_heavy_comes_with_it() -> None:
    heavy = {plain(DISTRIBUTIONS.get(name, name)) for name in ABSENT}
    assert not heavy & set(closure(EXTRA))


def test_what_is_compiled_is_known_to_have_wheels_for_aarch64() -> None:
    compiled = {
        name
        for name, found in closure(EXTRA).items()
        if not re.search(r"^Tag: \S+-none-any$", found.read_text("WHEEL") or "", re.MULTILINE)
    }
    assert compiled == COMPILED


def test_what_the_runner_imports_only_when_it_needs_it_is_there_too() -> None:
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
