"""Effects that have several forms, such as a link whose centre is elsewhere or that is heavier."""

from __future__ import annotations

from ..policy import POLICY
from .equations import Entry
from .selection import Selection, cost_of, gain_of, loss_without, selection_of, with_new
from .torque_regression import Chosen, Regression, Solution


def in_best_form(new: Chosen, beside: Chosen, regression: Regression) -> Chosen:
    """Return new effects, each in the form that leaves least on data that were not fitted.

    A heavier link and one whose centre is elsewhere explain nearly the same on their own axis. An extended
    form has to leave less than half of the excess of some axis.
    """
    for entry in new:
        best, *others = sorted(regression.forms(entry), key=lambda form: form.is_extended)
        found = _with_form(new, entry, best, beside, regression)
        for form in others:
            tried = _with_form(new, entry, form, beside, regression)
            if form.is_extended == best.is_extended:
                better = tried.test_loss.sum() < found.test_loss.sum()
            else:
                gain = gain_of(tried, found, regression)
                better = gain.max() > 1.0 - POLICY.exchange_left and gain.sum() > 0.0
            best, found = (form, tried) if better else (best, found)
        new = tuple(best if e is entry else e for e in new)
    return new


def _with_form(new: Chosen, entry: Entry, form: Entry, beside: Chosen, regression: Regression) -> Solution:
    way = tuple(form if e is entry else e for e in new)
    return regression.solved(with_new(beside, way))


def reformed(
    now: Selection, regression: Regression, seen: frozenset[frozenset[Entry]] = frozenset()
) -> Selection:
    """Return the selection with each effect in its best form beside all others, and one form instead of
    several effects.

    A payload and a lighter link are together a link whose centre is elsewhere; links whose centres are
    elsewhere, and a payload, are together a payload off its site.
    """
    this = frozenset(now.chosen)
    if this in seen:  # the forms of two effects may each want the other's first
        return now
    seen |= {this}
    for entry in now.chosen:
        others = tuple(e for e in now.chosen if e is not entry)
        (best,) = in_best_form((entry,), others, regression)
        if best is not entry:
            return reformed(selection_of((*others, best), regression), regression, seen)
        for form in regression.forms(entry)[1:]:
            fewer = selection_of((*others, form), regression)
            for out in (e for e in others if regression.axes_of(e) & regression.axes_of(entry)):
                rest = selection_of(tuple(e for e in fewer.chosen if e is not out), regression)
                if loss_without((out,), rest, now, regression) <= 1.0:
                    fewer = rest
            if len(fewer.chosen) < len(now.chosen) and _rank(fewer) <= _rank(now):
                return reformed(fewer, regression, seen)
    return now


def _rank(selection: Selection) -> tuple[tuple[int, int], float]:
    return cost_of(selection.chosen), float(selection.solution.test_loss.sum())
