"""The verdict of a search: consistent, missing effect, partly explained or unexplained."""

from __future__ import annotations

from workbench.core import Verdict

from .acceptance import contradicts_holdout
from .may_be_named import may_be_named
from .policy import POLICY
from .search_result import SearchResult

NAMED = ("missing_effect", "partly_explained")  #: verdicts with findings


def verdict_of(found: SearchResult) -> Verdict:
    """Return the verdict of a search."""
    if found.consistent_before:
        return "unexplained" if refuted(found) else "consistent"
    explains = found.consistent_after or max(found.explained, found.median_explained) >= POLICY.explained
    if found.adequacy and not explains and not refuted(found):
        return "partly_explained"
    whole = found.steps and explains and not refuted(found)
    named = whole and may_be_named(found.final, found.final_data, found.adequacy) and found.are_the_laws
    return "missing_effect" if named else "unexplained"


def refuted(found: SearchResult) -> bool:
    """Return whether the held-out error contradicts a fit that explains the training recordings.

    Where the holdout was informative from the start, it is part of the share that is explained.
    """
    informative = not (found.consistent_before or found.start_data.holdout_uninformative)
    return not informative and contradicts_holdout(found.final, found.final_data)
