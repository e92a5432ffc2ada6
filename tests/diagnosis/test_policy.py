"""Thresholds of the diagnosis stand in one place, each with its meaning, and can be changed for a while."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import FrozenInstanceError, fields
from pathlib import Path

import pytest

import workbench.diagnosis
from workbench.core import EffectKey, Estimate
from workbench.diagnosis.policy import POLICY, Policy, trial
from workbench.diagnosis.significance import is_significant
from workbench.diagnosis.work_budget import WorkBudget
from workbench.models import AppliedEffect

from .rig import recordings

FOLDER = Path(workbench.diagnosis.__file__).parent
MODULES = {str(path.relative_to(FOLDER)): path.read_text("utf-8") for path in sorted(FOLDER.rglob("*.py"))}
OWN = MODULES.pop("policy.py")
NAMES = [field.name for field in fields(Policy)]
#: What numbers of the numerics are called: steps, tolerances, what stands for infinite, or their unit.
NUMERICAL = re.compile(r"(STEP|RIDGE|TOLERANCE|OVERFLOW|INTERVAL|_S|_HZ)$")


@pytest.mark.parametrize("name", NAMES)
def test_each_threshold_is_used_and_says_what_it_means(name: str) -> None:
    assert any(re.search(rf"\bPOLICY\.{name}\b", text) for text in MODULES.values()), "nothing reads it"
    (line,) = re.findall(rf"^    {name}: (?:int|float) = \S+  # (.+)$", OWN, flags=re.M)
    assert len(line.split()) > 3


def test_all_that_is_read_is_there() -> None:
    read = {name for text in MODULES.values() for name in re.findall(r"\bPOLICY\.(\w+)", text)}
    assert read == set(NAMES)


@pytest.mark.parametrize("module", MODULES)
def test_thresholds_are_read_when_they_are_asked_for(module: str) -> None:
    """One that is read on import, as a default is, would not follow a trial."""
    assert not [node.attr for node in _outside_functions(ast.parse(MODULES[module])) if _is_threshold(node)]


@pytest.mark.parametrize("module", MODULES)
def test_other_modules_have_no_numbers_but_those_of_numerics(module: str) -> None:
    for name, value in _constants(ast.parse(MODULES[module])):
        assert not isinstance(value, float) or NUMERICAL.search(name), f"{name} = {value}: a threshold?"


def test_decisions_follow_a_trial() -> None:
    size = AppliedEffect(EffectKey("coulomb_friction", "knee"), {"torque": Estimate(0.35, 0.1, "N*m")})
    training, _ = recordings(seed=1)
    most = WorkBudget.for_search(training).most
    assert is_significant(size)
    with trial(significant=4.0, budget_steps=2.0 * most) as policy:
        assert policy.significant == POLICY.significant == 4.0
        assert not is_significant(size)
        assert WorkBudget.for_search(training).most == 2.0 * most
    assert is_significant(size)
    assert WorkBudget.for_search(training).most == most


def test_what_a_trial_changed_comes_back_whatever_happens() -> None:
    with pytest.raises(RuntimeError, match="half way"), trial(tie=0.5, most_effects=1):
        assert (POLICY.tie, POLICY.most_effects) == (0.5, 1)
        with trial(tie=0.7):
            assert POLICY.tie == 0.7
        assert POLICY.tie == 0.5
        raise RuntimeError("half way")
    assert Policy() == POLICY


def test_names_that_are_none_are_refused_and_change_nothing() -> None:
    with pytest.raises(ValueError, match="no field of Policy: tye"), trial(tie=0.5, tye=0.1):
        pytest.fail("never here")
    assert Policy() == POLICY
    with pytest.raises(FrozenInstanceError):
        POLICY.tie = 0.5  # type: ignore[misc]


def _is_threshold(node: ast.AST) -> bool:
    return isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "POLICY"


def _outside_functions(node: ast.AST) -> Iterator[ast.AST]:
    """All that runs on import: not the bodies of functions, but their defaults."""
    for name, value in ast.iter_fields(node):
        if isinstance(node, ast.FunctionDef | ast.Lambda) and name == "body":
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield child
                yield from _outside_functions(child)


def _constants(module: ast.Module) -> Iterator[tuple[str, object]]:
    """Names and values of constants of a module, those of several on one line too."""
    for node in module.body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
            several = isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple)
            pairs = zip(target.elts, node.value.elts, strict=True) if several else [(target, node.value)]
            for name, value in pairs:
                if isinstance(value, ast.Constant | ast.UnaryOp):
                    yield ast.unparse(name), ast.literal_eval(value)
