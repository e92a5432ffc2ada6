"""What the code imports is what the package declares and what the lock pins."""

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
#: Modules whose distribution goes by another name.
DISTRIBUTIONS = {"pinocchio": "pin", "pydrake": "drake", "tomli_w": "tomli-w", "can": "python-can"}


def third_party(folder: str) -> set[str]:
    own = {"workbench", "tests", *sys.stdlib_module_names}
    own |= {entry.stem for entry in (ROOT / "benchmarks").iterdir()}  # scripts find what lies beside them
    files = (ROOT / folder).rglob("*.py")
    modules = {module.split(".")[0] for file in files for module in imported(file)} - own
    return {DISTRIBUTIONS.get(module, module) for module in modules}


def imported(file: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module or ""


def names(requirements: list[str]) -> set[str]:
    return {re.split(r"[\[<>=!~; ]", line)[0].lower().replace("_", "-") for line in requirements}


def test_dependencies_are_what_the_package_imports() -> None:
    assert names(PROJECT["dependencies"]) == third_party("workbench")


def test_tests_and_benchmarks_need_no_more_than_the_dev_extra() -> None:
    declared = names(PROJECT["dependencies"]) | names(PROJECT["optional-dependencies"]["dev"])
    assert third_party("tests") | third_party("benchmarks") <= declared


def test_the_lock_pins_every_requirement_and_names_no_host() -> None:
    text = (ROOT / "requirements.lock").read_text()
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    assert all(re.fullmatch(r"[\w.-]+==[\w.]+", line) for line in lines), "exact versions only"
    build = tomllib.loads((ROOT / "pyproject.toml").read_text())["build-system"]["requires"]
    declared = names([*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["dev"], *build])
    assert declared <= names(lines)
