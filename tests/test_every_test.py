"""What is asked of every test: a name that fits a line, something that can fail, no private name replaced."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

HERE = Path(__file__).parent
_LONGEST = 59  # characters of a name, so that a report has it on one line
_REPLACES = {"setattr", "delattr", "setitem", "object"}  # of `monkeypatch` and `mock.patch`
_FAILS = {"assert", "raises", "fail", "warns"}


@cache
def trees() -> dict[str, ast.Module]:
    return {str(file.relative_to(HERE)): ast.parse(file.read_text()) for file in sorted(HERE.rglob("*.py"))}


def functions() -> Iterator[tuple[str, str, set[str]]]:
    """File, name, and the names of what is called in it, ``assert`` among them."""
    for file, tree in trees().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                yield file, node.name, {name for each in ast.walk(node) if (name := _called(each))}


def _called(node: ast.AST) -> str:
    if isinstance(node, ast.Call):
        return node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
    return "assert" if isinstance(node, ast.Assert) else ""


def test_names_fit_a_line_and_each_can_fail() -> None:
    """One asserts, or calls what does, however far down."""
    known = list(functions())
    tests = [(file, name, of) for file, name, of in known if name.startswith("test_")]
    assert len(tests) > 1000 and not [f"{file}: {name}" for file, name, _ in tests if len(name) > _LONGEST]
    can = {*_FAILS, "assert_allclose", "assert_array_equal"}
    while more := {name for _, name, of in known if of & can} - can:
        can |= more
    assert not [f"{file}: {name}" for file, name, of in tests if not of & can]


def test_no_private_name_is_replaced() -> None:
    found = []
    for file, tree in trees().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") in _REPLACES:
                words = [part for each in node.args[:2] for part in _words(each)]
                if any(word.startswith("_") and not word.startswith("__") for word in words):
                    found.append(f"{file}, line {node.lineno}")
    assert not found


def _words(node: ast.expr) -> list[str]:
    """The parts of a dotted name, written as such or in quotes."""
    if isinstance(node, ast.Constant):
        return node.value.split(".") if isinstance(node.value, str) else []
    return ast.unparse(node).split(".") if isinstance(node, ast.Name | ast.Attribute) else []
