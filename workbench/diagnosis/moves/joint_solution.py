"""Effects on all axes, solved together along the measured motion, and which of them are certain."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from workbench.core import EffectKey
from workbench.effects import effect_named, kinds

from ..acceptance import at_noise_floor, lowers_error
from ..adequacy.command_path import ON_PATH, certain_on_path
from ..data import Data
from ..hypothesis import Fit, Hypothesis
from ..loss import explained, rescored
from ..may_be_named import axes_of_another_shape
from ..node import Growth, Node, is_consistent, with_last_step
from ..policy import POLICY
from ..problem import Problem, evaluated
from ..screening.rivals import rivals_of
from ..screening.selection import selection_of
from ..screening.torque_regression import Chosen, Regression
from ..search_result import AcceptedStep, steps_through
from .apart import certain_apart
from .joint_fit import Certain, beside_strangers, certain_of, certain_only


def of_all_axes(root: Node, problem: Problem) -> Iterator[Node]:
    """Return the joint solution; if it was grown before, the stored one.

    It is the answer where it takes more effects than may be added one by one, or where plain corrections
    reach the noise. Else what is no torque along the motion may be missing beside several that are certain.
    """
    first, node = problem.is_new("joint solution"), solve_jointly(problem)
    if node is None or not first:
        yield from () if node is None else (node,)
        return
    whole = len(node.steps) + len(node.near) > problem.limit or (
        _corrections_suffice(node) and not problem.one_effect_may_suffice
    )
    several = not (whole or node.by_links) and node.has_several_certain
    share = explained(problem.data, problem.start, node.current, node.data)
    enough = whole or node.by_links > 0.0 or (several and share > POLICY.certain_share)
    yield replace(node, enough=enough, growth=Growth() if several else None)


def _corrections_suffice(node: Node) -> bool:
    """Return whether corrections of drive and link parameters alone reach the noise floor."""
    keys = [step.added for step in node.steps]
    at_noise = node.done or at_noise_floor(node.current, node.data)
    return at_noise and len(keys) > 1 and all(k.axis and _corrects_a_number(k.effect) for k in keys)


def _corrects_a_number(effect: str) -> bool:
    """Return whether an effect corrects a number that every drive or link has."""
    return effect_named(effect).search.basic or kinds.is_additive(effect_named(effect))


def solve_jointly(problem: Problem) -> Node | None:
    """Return the joint solution; None if no torque was recorded, or no certain effect helps.

    The node has the effects that are certain; all effects where these are at the noise floor.
    """
    if not problem.solved:
        problem.solved.append(_solved(problem))
    return problem.solved[0]


def _solved(problem: Problem, bent: frozenset[str] = frozenset()) -> Node | None:
    """Return the joint solution; what follows positions of axes that are `bent` is not certain.

    Where what is left follows the position of an axis, effects of that position only came near to its torque.
    """
    problem.progress("solving for all axes and effects at once, along the measured motion")
    if problem.inverse_dynamics is None:
        return None
    data, start, regression = problem.inverse_dynamics
    found, by_torque = _by_torque(regression, start, data, problem.seed, bent)
    # what the drives make of their commands acts on a machine in its loop alone
    path = certain_on_path(regression.linearisation) if problem.data.replay.simulates else ()
    whole = replace(by_torque, free=(*by_torque.free, *path))
    # where nearly all is errors of the links, no other effect has to be searched for
    links = found.by_links if found.by_links >= POLICY.explained else 0.0
    if not whole.free:
        near = found.whole.hypothesis.free
        return Node(problem.start, problem.data, jointly=True, near=near, by_links=links) if links else None
    known = {**(found.known if by_torque.free else {}), **{a.key: ON_PATH for a in path}}
    sure_in_loop = confirmed(whole, problem, certain=whole.keys <= known.keys())
    named = evaluated(sure_in_loop, data.run([sure_in_loop.model])[0], data)
    entries = tuple(e for e in found.chosen.chosen if e.key in sure_in_loop.keys)
    node = _in_the_loop(_steps(found.regression, entries, named, start, data), problem)
    if node is not None and not (found.known or bent):
        bent = axes_of_another_shape(node.current, node.data)
        if bent:
            return _solved(problem, bent)
    near = tuple(a for a in found.whole.hypothesis.free if a.key not in sure_in_loop.keys)
    adequacy = {key: stands for key, stands in known.items() if key in sure_in_loop.keys}
    return None if node is None else replace(node, jointly=True, adequacy=adequacy, near=near, by_links=links)


def _by_torque(
    regression: Regression, start: Fit, data: Data, seed: int, bent: frozenset[str]
) -> tuple[Certain, Hypothesis]:
    """Return what was selected along the measured motion, and what of it stays: all where noise explains the
    rest, otherwise what is certain; no effect where that does not lower the error.
    """
    found = certain_of(regression, start, data, bent=bent)
    if found is None:
        return Certain(regression, selection_of((), regression), start, {}), start.hypothesis
    named: Fit | None = found.whole
    if found.known or found.by_links or not is_consistent(data, found.whole.mean_squares):
        found = certain_apart(found, start, data, seed)
        named = certain_only(found.whole, found.known, data)
        if named and not found.apart:
            named = beside_strangers(found.whole, named, found.known, start, data, seed)
    stays = named is not None and lowers_error(named, start, data)
    return found, named.hypothesis if named and stays else start.hypothesis


def confirmed(found: Hypothesis, problem: Problem, certain: bool) -> Hypothesis:
    """Return the effects without those that raise the error in the closed loop.

    What explains a torque by chance seldom moves the machine as it moved. Of effects that are `certain` by
    themselves none goes as long as all together lower the error.
    """
    data, tried = problem.data, [found]
    best: Fit | None = None
    while data.replay.simulates and tried:
        runs = data.run([h.model for h in tried])
        fits = [evaluated(h, made, data) for h, made in zip(tried, runs, strict=True)]
        ran = sorted((f for f in fits if np.isfinite(f.mean_squares).all()), key=lambda f: f.test_loss)
        if best is not None and (not ran or ran[0].test_loss >= best.test_loss):
            break
        best = ran[0] if ran else None
        if best and (certain or at_noise_floor(best, data)) and lowers_error(best, problem.start, data):
            break
        whole = best.hypothesis if best else tried[0]
        fewer = [tuple(a for a in whole.free if a is not out) for out in whole.free]
        tried = [replace(whole, free=free) for free in fewer if free]
    return best.hypothesis if best and lowers_error(best, problem.start, data) else found


def _steps(regression: Regression, chosen: Chosen, end: Fit, before: Fit, data: Data) -> list[AcceptedStep]:
    """Return one step for each effect, all with the final values: as they were chosen, then others."""
    values = {a.key: a for a in end.hypothesis.free}
    order = [*(e.key for e in chosen), *(key for key in values if key not in {e.key for e in chosen})]
    hypotheses = [
        replace(end.hypothesis, free=tuple(values[key] for key in order[: k + 1])) for k in range(len(order))
    ]
    runs = data.run([h.model for h in hypotheses[:-1]])
    fits = [evaluated(h, r, data) for h, r in zip(hypotheses[:-1], runs, strict=True)] + [end]
    told: dict[EffectKey, dict[str, Any]] = {}
    for entry in chosen:
        ratios, alike = rivals_of(regression, chosen, entry)
        told[entry.key] = {"indistinguishable": alike, "loss_ratios": ratios}
    pairs = zip(order, fits, strict=True)
    return list(steps_through(before, pairs, data, lambda key: told.get(key, {})))


def _in_the_loop(steps: Sequence[AcceptedStep], problem: Problem) -> Node | None:
    """Return the steps replayed in the loop; None if the error does not fall there."""
    data = problem.data
    if data.replay.simulates:
        runs = data.run([s.fit.hypothesis.model for s in steps])
        fits = [evaluated(s.fit.hypothesis, r, data) for s, r in zip(steps, runs, strict=True)]
        if not np.isfinite(fits[-1].mean_squares).all() or not lowers_error(fits[-1], problem.start, data):
            return None
        runs_at_all = [f if np.isfinite(f.mean_squares).all() else fits[-1] for f in fits]
        steps = [replace(s, fit=f, data=data) for s, f in zip(steps, runs_at_all, strict=True)]
    before = Node(rescored(steps[-1].fit, data), data, tuple(steps))
    return with_last_step(before, steps[-1], problem.seed)
