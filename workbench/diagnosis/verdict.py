"""The verdict of a search: consistent, missing effect, partly explained or unexplained."""

from __future__ import annotations

from workbench.core import Verdict
from workbench.effects import effect_named, kinds

from .acceptance import contradicts_holdout
from .evidence.residual_evidence import ResidualEvidence
from .moves.overestimated import Overestimated, overestimated
from .policy import POLICY
from .search_result import SearchResult
from .significance import is_significant

NAMED = ("missing_effect", "partly_explained")  #: verdicts with findings


def verdict_of(found: SearchResult) -> tuple[Verdict, Overestimated | None]:
    """The verdict, and overestimated parameters where they were searched."""
    if found.consistent_before:
        return "unexplained" if refuted(found) else "consistent", None
    explains = found.consistent_after or max(found.explained, found.median_explained) >= POLICY.explained
    if found.adequacy and not explains and not refuted(found):
        return "partly_explained", None
    named = (
        found.steps
        and explains
        and not refuted(found)
        and not _another_shape(found)
        and all(is_significant(a) for a in found.final.hypothesis.free)
        and not _far_off_contact(found)
    )
    doubtful = not found.consistent_after or found.final.hypothesis.size > POLICY.plain_parameters
    less = overestimated(found) if doubtful else None
    if less is not None and less.plainer_than(found):
        named = False
    return "missing_effect" if named else "unexplained", less


def refuted(found: SearchResult) -> bool:
    """Whether the held-out error contradicts a fit that explains the training recordings.

    Where the holdout was informative from the start, it is part of the share that is explained.
    """
    informative = not (found.consistent_before or found.start_data.holdout_uninformative)
    return not informative and contradicts_holdout(found.final, found.final_data)


def _another_shape(found: SearchResult) -> bool:
    """Whether a position-dependent torque was named and the residual still depends on positions.

    A spring of another law, or one across two axes, is followed a long way by springs and cogging together.
    """
    added = found.final.hypothesis.free
    named = any(kinds.depends_on(effect_named(a.key.effect)) == ("position",) for a in added)
    return named and ResidualEvidence(found.final_data, found.final).follows_positions


def _far_off_contact(found: SearchResult) -> bool:
    """Whether a search with contacts that make and break ends well above the noise.

    A foot a millimetre off is many newtons, nearly all of which any other way to lift it takes off as well.
    """
    data = found.final_data
    error, floor = data.score(found.final.mean_squares), data.score(data.floor)
    return not data.replay.smooth and error > POLICY.ground_error * floor
