"""The numbers of all links of a robot at once, from recordings of its motion and torque."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.linalg import block_diag

from workbench.comparison import on_ground
from workbench.core import EffectKey, InputError
from workbench.diagnosis import LinkEquations, Normal, jackknife, link_equations, total
from workbench.effects import axis_units, is_parallelogram, link_of, load_model
from workbench.models import Model, rotors
from workbench.recordings import Source, load_recordings

from .possible import TRUSTS, PossibleFit, fit_possible
from .result import AxisTorque, LinkFound, LinkNumber, LinksIdentification
from .rigid_body import DIRECTIONS, NUMBERS, Belief, inertial_of

_ROTOR, _SPRING = "reflected_inertia", "parallel_spring"
_WORTH = 0.05  # of the squares on data that were not fitted, that a spring has to take away
_ROUNDING = 1e-9  # of the size of a number: what is no change
_COUNT = len(DIRECTIONS)  # unknowns of a link


def identify_links(
    model: Model | str | Path,
    training: Source | Iterable[Source],
    held_out: Source | Iterable[Source] = (),
    *,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
) -> LinksIdentification:
    """Return masses, centres of mass and inertias of all links that explain the torque best.

    All ten numbers of each link are fitted together, beside damping, dry friction and constant torque of each
    drive, beside rotors where the model states none, and beside springs if these predict better. Links stay
    bodies that can exist, and as close to the model's as the data allow: how close is chosen on blocks of
    data that are left out in turn.

    Args:
        model: with links that are roughly known, and with effects that are no number of a link; or its file
            or name.
        training: recordings to fit, one or several, or their files.
        held_out: recordings that only judge; without them, the blocks that are left out do.
        seed: of the noise simulations.
        progress: told what is being done.

    Raises:
        InputError: a model without such links, or recordings without a known torque.
        SimulationError: no solution was found.
    """
    model = load_model(model)
    training, held_out = load_recordings(training, some=True), load_recordings(held_out)
    links = {axis: link for axis in model.axes if (link := link_of(model, axis)) is not None}
    if is_parallelogram(model) or model.carried is not None or not links:
        raise InputError(
            f"the links of model '{model.name}' cannot be fitted one by one", file=model.source,
            remedy="for a parallel leg use 'identify leg'",
        )  # fmt: skip
    grounded = next((r for r in (*training, *held_out) if model.floats or on_ground(r)), None)
    if grounded is not None:
        raise InputError(
            "the forces of the ground are not known", file=grounded.source,
            remedy="fit the links to recordings with a fixed base, where the feet touch nothing",
        )  # fmt: skip
    progress("reading the torque along the measured motion")
    equations = link_equations(model, training, held_out, seed)
    if equations is None:
        raise InputError(
            "the torque along this motion is not known", file=training[0].source, column="torque_measured",
            remedy="log it, or state the law of the controller under [controller]",
        )  # fmt: skip
    progress("fitting all links together")
    beliefs = {axis: Belief.of(link) for axis, link in links.items()}
    starts, joints = [b.start for b in beliefs.values()], dict(zip(model.axes, model.links[1], strict=True))
    problem = _Problem.of(model, equations, beliefs)
    problem, fit, springs = _with_springs(problem, starts)
    found = []
    for k, (axis, belief) in enumerate(beliefs.items()):
        own = slice(problem.count + _COUNT * k, problem.count + _COUNT * (k + 1))
        numbers, link = _numbers(belief, fit, own), links[axis]
        after = inertial_of(np.array([n.value for n in numbers.values()]))
        found.append(LinkFound(axis, joints[axis], link.body, link.inertial, after, numbers))
    return LinksIdentification(
        model.name,
        tuple(found),
        _torques(model, equations, problem, fit),
        fit.identifiable(problem.count),
        bool(held_out),
        springs,
    )


def _with_springs(
    problem: _Problem, starts: Sequence[np.ndarray]
) -> tuple[_Problem, PossibleFit, tuple[str, ...]]:
    """Return the problem with the springs that predict better, its fit, and their axes.

    A spring that is missing would bend links that are right; one that is not there hides what a link weighs.
    """
    springs = {key for key in problem.drives if key.effect == _SPRING}
    taken: set[EffectKey] = set()
    now = problem.without(springs)
    fit = now.fitted(starts)
    while springs - taken:
        tries = {key: problem.without(springs - taken - {key}) for key in sorted(springs - taken, key=str)}
        left = {key: some.fitted(starts, (fit.trust,)).left for key, some in tries.items()}
        best = min(left, key=lambda key: left[key])
        if left[best] > (1.0 - _WORTH) * fit.left:
            break
        taken, now = taken | {best}, tries[best]
        fit = now.fitted(starts)
    return now, fit, tuple(sorted(str(key.axis) for key in taken))


@dataclass(frozen=True, eq=False)
class _Problem:
    """The equations in unknowns of one size: first those of the drives, then steps of the links.

    Attributes:
        drives: the effect of each unknown of the drives.
        held: 1 where the file has an unknown's value, otherwise 0, (C,).
        blocks, judging: equations, as `LinkEquations` has them.
    """

    drives: tuple[EffectKey, ...]
    held: np.ndarray
    blocks: Sequence[Sequence[Normal]]
    judging: Sequence[Sequence[Normal]]

    @staticmethod
    def of(model: Model, equations: LinkEquations, beliefs: Mapping[str, Belief]) -> _Problem:
        """Return the problem, with rotors of drives for which the model states none."""
        count = len(equations.drives)
        size = np.sqrt(np.diag(total([axis for block in equations.blocks for axis in block]).gram))[:count]
        unit = 1.0 / np.where(size > 0.0, size, 1.0)
        none = np.zeros((_COUNT, 0))  # of an axis without a link
        links = [beliefs[a].unit if a in beliefs else none for a in model.axes]
        there = np.asarray(block_diag(np.diag(unit), *links))
        blocks, judging = (
            [[axis.mapped(there) for axis in block] for block in some]
            for some in (equations.blocks, equations.judging)
        )
        held = np.concatenate([np.zeros(count), np.ones(there.shape[1] - count)])
        stated = {axis for axis, rotor in zip(model.axes, rotors(model)[0], strict=True) if rotor > 0.0}
        kept = [key.effect != _ROTOR or key.axis not in stated for key in equations.drives]
        return _Problem(equations.drives, held, blocks, judging).only(kept)

    @property
    def count(self) -> int:
        """Return the number of unknowns of the drives."""
        return len(self.drives)

    def fitted(self, starts: Sequence[np.ndarray], trusts: Sequence[float] = TRUSTS) -> PossibleFit:
        """Return the best fit; `starts` and `trusts` as `fit_possible` takes them."""
        return fit_possible([total(block) for block in self.blocks], self.held, starts, trusts)

    def without(self, out: Container[EffectKey]) -> _Problem:
        """Return the problem without some effects of the drives."""
        return self.only([key not in out for key in self.drives])

    def only(self, kept: Sequence[bool], *, links: bool = True) -> _Problem:
        """Return the problem with some unknowns of the drives, and with or without those of the links."""
        index = np.flatnonzero([*kept, *[links] * (len(self.held) - self.count)]).tolist()
        blocks, judging = (
            [[axis.pick(index) for axis in block] for block in some] for some in (self.blocks, self.judging)
        )
        drives = tuple(key for key, keep in zip(self.drives, kept, strict=True) if keep)
        return _Problem(drives, self.held[index], blocks, judging)

    def left(self, fit: PossibleFit | None) -> np.ndarray:
        """Return the root mean square (n,) that a fit, or none, leaves on data that were not fitted."""
        judged = self.judging or self.blocks
        if fit is None:
            solutions = [np.zeros(len(self.held))] * len(judged)
        else:
            solutions = [fit.whole] * len(judged) if self.judging else list(fit.each)
        squares = [[axis.after(x) for axis in block] for block, x in zip(judged, solutions, strict=True)]
        samples = [[axis.samples for axis in block] for block in judged]
        return np.sqrt(np.sum(squares, axis=0) / np.sum(samples, axis=0))


def _numbers(belief: Belief, fit: PossibleFit, own: slice) -> dict[str, LinkNumber]:
    """Return the numbers of one link, of which `own` are the steps."""
    change = belief.unit @ fit.whole[own]
    size = np.linalg.norm(belief.unit, axis=1)
    values = belief.numbers + np.where(np.abs(change) > _ROUNDING * size, change, 0.0)
    variance, before = (
        np.einsum("ki,ij,kj->k", belief.unit, x, belief.unit)
        for x in (fit.covariance[own, own], np.eye(_COUNT))
    )
    stds = np.sqrt(variance + jackknife(fit.each[:, own] @ belief.unit.T) ** 2)
    identifiable = np.clip(1.0 - variance / before, 0.0, 1.0)
    rows = np.stack([belief.numbers, values, stds, identifiable], axis=1)
    return {
        name: LinkNumber(float(before), float(value), float(std), float(share), unit)
        for (name, unit), (before, value, std, share) in zip(NUMBERS.items(), rows, strict=True)
    }


def _torques(
    model: Model, equations: LinkEquations, problem: _Problem, fit: PossibleFit
) -> tuple[AxisTorque, ...]:
    """Return what stays of the torque of each axis: as it is, beside the drives, and beside the links too."""
    drives = problem.only([True] * problem.count, links=False)
    left = problem.left(None), drives.left(drives.fitted(())), problem.left(fit)
    units = ("N*m" if unit == "rad" else "N" for unit in axis_units(model))
    rows = equations.unit[:, None] * np.stack(left, axis=1)
    return tuple(
        AxisTorque(axis, unit, float(before), float(with_drives), float(after), float(noise))
        for axis, unit, (before, with_drives, after), noise in zip(
            model.axes, units, rows, equations.noise, strict=True
        )
    )
