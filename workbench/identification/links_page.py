"""What ``workbench identify links`` says, as sentences, tables and a page."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.core.shown import Row
from workbench.models import Inertial
from workbench.report.numbers import number, percent, unit_text
from workbench.report.sheet import Section, Sheet, SheetTable
from workbench.report.wording import any_of

from .picture import links_figure
from .result import LinkFound, LinksIdentification

_IDENTIFIABLE = 0.99  # share of the variance that the data take away: known to a tenth
_MOST = 0.5  # share of the torque from which the links are the main cause
Rows = tuple[Row, Sequence[Row]]


def links_sentences(found: LinksIdentification) -> tuple[str, ...]:
    """Return the result, and what to know about it, one sentence each."""
    drives = f"friction, damping{', a spring' if found.springs else ''} and a constant torque of each drive"
    where = "on held-out recordings" if found.held_out else "on blocks of data that were not fitted"
    share = f"New numbers of the links explain {percent(found.share)} of the torque that"
    explained = f"{share} {drives} leave unexplained"
    if found.share <= 0.0:
        first = f"New numbers of the links explain nothing {where}: what is missing has another cause."
    elif found.share < _MOST:
        first = f"{explained}, {where}. Most of it has another cause."
    else:
        first = f"{explained}, {where}."
    count = sum(len(link.numbers) for link in found.links)
    identifiable = (
        f"About {found.identifiable:.0f} combinations of the {count} numbers are identifiable. Many sets of "
        "numbers need the same torque; the one nearest to the file was taken. All its bodies can exist."
    )
    if not found.springs:
        return first, identifiable
    springs = (
        f"A spring on {any_of(found.springs, 'and')} was fitted with the links, because data that were not "
        "fitted show it; the new file does not have it."
    )
    return first, identifiable, springs


def axis_rows(found: LinksIdentification) -> Rows:
    """Return head and rows of the table of the torque that stays, by axis."""
    head = ("axis", "model as it is", "with drives", "with links too", "noise", "unit")
    rows = [
        (t.axis, *(number(x) for x in (t.before, t.drives, t.after, t.noise)), unit_text(t.unit))
        for t in found.torques
    ]
    return head, rows


def link_rows(found: LinksIdentification) -> Rows:
    """Return head and rows of the table of the links: the old and the new numbers."""
    return ("link", "mass [kg]", "centre of mass [mm]", "identifiable numbers"), [
        (
            f"{link.axis} ({link.body})",
            _change(number(link.before.mass), number(link.after.mass)),
            _change(_centre(link.before), _centre(link.after)),
            f"{sum(n.identifiable >= _IDENTIFIABLE for n in link.numbers.values())} of {len(link.numbers)}",
        )
        for link in found.links
    ]


def _change(before: str, after: str) -> str:
    return before if before == after else f"{before} → {after}"


def _centre(inertial: Inertial) -> str:
    return " ".join(str(round(1e3 * x)) for x in inertial.centre)


def links_sheet(found: LinksIdentification) -> Sheet:
    """Return the page: what stays of the torque, and every number of every link."""
    first, *rest = links_sentences(found)
    left, links = (
        SheetTable(title, (head[0], *(f">{name}" for name in head[1:])), tuple(map(tuple, rows)))
        for title, (head, rows) in (
            ("Root mean square of the torque that stays unexplained", axis_rows(found)),
            ("Before and after, in the frame of each body", link_rows(found)),
        )
    )
    picture = links_figure(found), _words(found)
    worst = max(found.torques, key=lambda t: t.drives / t.noise)
    return Sheet(
        kind="links",
        model=found.model,
        tone="missing_effect" if found.share > 0.0 else "unexplained",
        sentence=first,
        lines=tuple(rest),
        key_numbers=(
            ("Explained by the links", percent(found.share), "of the torque that friction and damping leave"),
            ("Identifiable", f"{found.identifiable:.0f}", f"combinations of {len(found.links) * 10} numbers"),
            (
                f"Torque left on {worst.axis}",
                number(worst.after),
                f"{unit_text(worst.unit)}; was {number(worst.before)}",
            ),
        ),
        sections=(
            Section("torque", "The torque that stays", tables=(left,), picture=picture),
            Section("links", "The links", tables=(links,)),
            Section("numbers", "All numbers", tables=tuple(map(_numbers, found.links))),
        ),
    )  # fmt: skip


def _words(found: LinksIdentification) -> str:
    return "Torque that stays, times the noise: " + "; ".join(
        f"{t.axis} {number(t.before / t.noise)}, {number(t.drives / t.noise)}, {number(t.after / t.noise)}"
        for t in found.torques
    )


def _numbers(link: LinkFound) -> SheetTable:
    """Return every number of one link."""
    rows = [
        (
            name.replace("_", " "),
            number(n.before, 4),
            number(n.value, 4),
            number(1.96 * n.std),
            percent(n.identifiable),
            unit_text(n.unit),
        )
        for name, n in link.numbers.items()
    ]
    return SheetTable(
        f"{link.axis}: body {link.body}, about its origin",
        ("number", ">before", ">after", ">± (95 %)", ">identifiable", "unit"),
        tuple(rows),
    )
