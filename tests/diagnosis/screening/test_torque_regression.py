"""Effects on many axes as one linear problem: solved in groups, and what stands for one of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import numpy as np

from workbench.core import EffectKey
from workbench.diagnosis.fitting.normal_equations import Normal
from workbench.diagnosis.screening.equations import Entry
from workbench.diagnosis.screening.forms import reformed
from workbench.diagnosis.screening.rivals import rivals_of
from workbench.diagnosis.screening.selection import selection_of
from workbench.diagnosis.screening.torque_regression import Regression

ROWS, FOLDS = 300, 4


def problem(columns: np.ndarray, torque: np.ndarray, entries: Sequence[Entry]) -> Regression:
    """Of columns (N, n, C) and torques (N, n), rows in folds."""
    axes = range(torque.shape[1])
    folds = tuple(
        tuple(
            Normal(x[:, k].T @ x[:, k], x[:, k].T @ y[:, k], float(y[:, k] @ y[:, k]), len(y)) for k in axes
        )
        for x, y in zip(np.split(columns, FOLDS), np.split(torque, FOLDS), strict=True)
    )
    floor = np.full(len(axes), 1e-3)
    limits = {e: (np.full(len(e.linear), -np.inf), np.full(len(e.linear), np.inf)) for e in entries}
    return Regression(cast(Any, None), tuple(entries), (), {}, folds, None, floor, floor, limits)


def entry(effect: str, axis: str, *linear: int) -> Entry:
    return Entry(EffectKey(effect, axis), {}, list(linear), None, 1.0)


def test_axes_that_share_no_effect_are_solved_apart() -> None:
    random = np.random.default_rng(0)
    columns, torque = np.zeros((ROWS, 3, 4)), random.normal(size=(ROWS, 3))
    for axis, column in ((0, 0), (1, 1), (0, 2), (1, 2), (2, 3)):  # the third acts on two axes
        columns[:, axis, column] = random.normal(size=ROWS)
    torque += np.einsum("knc,c->kn", columns, [1.0, -2.0, 0.5, 3.0])
    keys = ("viscous_damping", "a"), ("viscous_damping", "b"), ("payload_mass", "a"), ("viscous_damping", "c")
    entries = [entry(effect, axis, k) for k, (effect, axis) in enumerate(keys)]
    found = problem(columns, torque, entries).solved(entries)
    whole = columns.reshape(-1, 4)
    np.testing.assert_allclose(
        found.coefficients, np.linalg.lstsq(whole, torque.ravel(), rcond=None)[0], atol=1e-5
    )
    left = np.zeros(3)
    for fold in np.split(np.arange(ROWS), FOLDS):
        rest = np.setdiff1d(np.arange(ROWS), fold)
        fit = np.linalg.lstsq(columns[rest].reshape(-1, 4), torque[rest].ravel(), rcond=None)[0]
        left += np.sum((torque[fold] - columns[fold] @ fit) ** 2, axis=0)
    np.testing.assert_allclose(found.validated, left / ROWS, rtol=1e-5)


def test_what_explains_another_part_is_no_other_name() -> None:
    random = np.random.default_rng(1)
    own, apart, unknown = np.linalg.qr(random.normal(size=(ROWS, 3)))[0].T
    nearly = own + 0.05 * random.normal(size=ROWS) * np.abs(own).mean()
    columns = np.stack([own, apart, nearly], axis=1)[:, None]
    torque = (own + apart + 9.0 * unknown)[:, None]
    effects = "viscous_damping", "parallel_spring", "reflected_inertia"
    true, other, alike = entries = [entry(effect, "a", k) for k, effect in enumerate(effects)]
    _, tied = rivals_of(problem(columns, torque, entries), [true], true)
    assert alike.key in tied and other.key not in tied


def test_a_form_replaces_only_an_effect_whose_work_it_does() -> None:
    """A mass explains nearly all, and a damping nearly all of the rest, in whichever form the mass is."""
    random = np.random.default_rng(2)
    mass, damping, odd = random.normal(size=(3, ROWS))
    columns = np.stack([mass, mass + 1e-3 * odd, damping], axis=-1)[:, None]
    torque = columns @ [0.0, 10.0, 1.0] + 0.1 * random.normal(size=(ROWS, 1))
    key, lever = EffectKey("first_moment_error", "a"), {"lever": 0.1, "aside": 0.0}
    forms = [Entry(key, shape, [k], None, 1.0) for k, shape in enumerate((lever, lever | {"gyration": 0.02}))]
    damped = entry("viscous_damping", "a", 2)
    regression = problem(columns, torque, [*forms, damped])
    assert damped in reformed(selection_of((forms[0], damped), regression), regression).chosen
    columns[:, 0, 1] += 0.1 * damping  # a form that has the damping in it takes its place
    both = problem(columns, torque, [*forms, damped])
    assert damped not in reformed(selection_of((forms[0], damped), both), both).chosen
