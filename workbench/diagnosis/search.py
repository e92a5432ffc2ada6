"""The search for missing effects, from a model and its recordings to the result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.comparison import Simulated, cannot_run, noise_rules
from workbench.core import Disagreement, Identifiability, Recording, SimulationError
from workbench.models import Model

from .adequacy.link_errors import link_errors
from .checks.units import differing_units
from .data import gather
from .explore import explore
from .loss import explained, median_explained
from .moves.joint_solution import solve_jointly
from .node import Node, is_consistent
from .node_acceptance import are_the_laws
from .policy import POLICY
from .problem import Problem, Progress, starting_fit
from .screening.disagreement import disagreements
from .screening.identifiability import identifiability_of
from .search_result import SearchResult


class UnstableLoop(SimulationError):
    """Raised if the model as given cannot run in the loops of its recordings."""


@dataclass(frozen=True)
class Asked:
    """A search request: the problem with the unchanged model, its runs, and the recordings as given."""

    problem: Problem
    runs: Simulated
    training: Sequence[Recording]


def ask(
    model: Model,
    training: Sequence[Recording],
    held_out: Sequence[Recording] = (),
    seed: int = 0,
    limit: int | None = None,
    progress: Progress = lambda text: None,
) -> Asked:
    """Return the search request for a model and its recordings, with the noise simulated.

    Args:
        model: where to start.
        training: recordings for fitting.
        held_out: recordings for testing; without informative ones, folds of the training data are left out.
        seed: of the noise simulations.
        limit: most effects to add one by one; None: as many as the policy has.
        progress: told what is being done.

    Raises:
        UnstableLoop: the model cannot run the recordings.
    """
    progress("simulating the model and its noise")
    try:
        data, simulated = gather(model, training, held_out, seed)
    except SimulationError as error:
        raise UnstableLoop(str(error)) from error
    if noise_rules(data.score(data.floor), data.recordings):
        raise UnstableLoop(cannot_run(model.name, data.score(data.floor)))
    most = POLICY.most_effects if limit is None else limit
    problem = Problem(starting_fit(model, data, simulated.clean), data, most, seed, progress)
    return Asked(problem, simulated, training)


def search(asked: Asked, *, only_jointly: bool = False) -> SearchResult:
    """Return the result of a search, which ends at the noise floor or when nothing helps.

    Moves are tried in the order of `moves.order`; `accepts` says which of the nodes they lead to is better.

    Args:
        asked: what is searched.
        only_jointly: ask nothing but the joint solution.
    """
    problem = asked.problem
    start, first, model = problem.start, problem.data, problem.start.hypothesis.model
    known = None if only_jointly else _distinguishable(problem)
    before = is_consistent(first, start.mean_squares)
    node, trace = Node(start, first, done=before), ()
    if not before:
        node, trace = (solve_jointly(problem) or node, ()) if only_jointly else explore(node, problem)
    current, data = node.current, node.data
    # a signal that is a little off after all that could be found is no sign of one more effect
    done = node.done or (len(node.steps) > 0 and is_consistent(data, current.mean_squares, by_signal=False))
    return SearchResult(
        model,
        start,
        first,
        asked.runs,
        node.steps,
        () if before or only_jointly or (node.jointly and problem.has_many_axes) else problem.screened,
        before,
        done,
        explained(first, start, current, data),
        median_explained(first, start, current, data) if node.diverges else 0.0,
        node.adequacy,
        node.near,
        known,
        # one set of values that explains all recordings refutes what but guessed at its cause
        () if only_jointly else _disagreeing(node, problem, done),
        node.jointly,
        None if only_jointly else problem.linear,
        trace,
        done or only_jointly or are_the_laws(node, problem),
        node.by_links or (0.0 if done or only_jointly else _by_links(node, problem)),
        node.by_links > 0.0,
    )


def _by_links(node: Node, problem: Problem) -> float:
    """Return the share of what a node leaves that errors of all links explain; 0 where that is not most."""
    if problem.inverse_dynamics is None:
        return 0.0
    data, _, regression = problem.inverse_dynamics
    errors = link_errors(regression, regression.without_shape(node.keys), data)
    return errors.share if errors else 0.0


def _distinguishable(problem: Problem) -> Identifiability | None:
    """Return what the recordings can tell apart; None if there is no linear problem."""
    if problem.linear is None:
        return None
    known = identifiability_of(problem.linear, problem.linearisation)
    problem.progress(f"the recordings can tell {len(known.separable)} of {known.count} effects apart")
    return known


def _disagreeing(node: Node, problem: Problem, done: bool) -> tuple[Disagreement, ...]:
    """Return how recordings contradict each other, beside all effects that were found or lower the error.

    One set of values that explains all of them refutes what but guesses at a cause.
    """
    recordings = problem.data.recordings
    units = differing_units(recordings)
    if done or units or problem.linear is None:
        return units
    beside = (*node.current.hypothesis.free, *node.near)
    return disagreements(problem.linear, [r.name for r in recordings], beside)
