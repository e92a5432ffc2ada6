"""The table of ``workbench check``."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.text import Text

from workbench.core import Check, Verification
from workbench.core.shown import Summary

from .layout import table, text, verdict
from .numbers import number, unit_text
from .response import words_of

#: Words of checks that are no words in a sentence.
_WORDS = {"frf": "frequency response", "jacobian": "Jacobian", "coriolis": "Coriolis torque", "s3n": "S3N"}


def quantity_name(check: str) -> str:
    """Return the name of a check as words: ``"serial_coriolis"`` is ``"serial Coriolis torque"``."""
    return " ".join(_WORDS.get(word, word) for word in check.split("_"))


def verification_table(result: Verification) -> Group:
    """Return a table: verdict, quantities with difference and tolerance, variants' inertia, facts."""
    checks = table("", "quantity", ("difference", "right"), ("allowed", "right"), "unit", "between")
    for column in (1, 4):
        checks.columns[column].no_wrap = True
    for check in result.checks:
        checks.add_row(
            "ok" if check.passed else Text("FAIL", style="bold red"),
            text(quantity_name(check.name)),
            f"{check.value:.1e}",
            f"{check.tolerance:.0e}",
            unit_text(check.unit),
            text(check.about),
        )
    parts: list[RenderableType] = [verdict(sentence(result), result.passed), checks]
    parts += [
        Text.assemble((f"{quantity_name(c.name)}: ", "bold"), text(c.hint)) for c in result.checks if _told(c)
    ]
    if result.variants:
        inertia = table("variant", ("M11", "right"), ("M12", "right"), ("M22 [kg m²]", "right"))
        for name, values in result.variants.items():
            inertia.add_row(words_of(name), *(f"{v:.5f}" for v in values))
        parts += [Text(), Text("Mass matrix at alpha = 90°, serial coordinates", style="bold"), inertia]
    if len(result.radius):
        low, high = float(result.radius.min()), float(result.radius.max())
        parts += [
            Text(),
            text(
                f"Explicit injection (the paper's method) is {'not ' if high >= 1 else ''}stable here: "
                f"spectral radius {low:.3f} to {high:.3f} over the knee's range; it has to be below 1."
            ),
        ]
    parts += [
        text(f"{about} {number(value)} {unit_text(unit)}".rstrip() + ".")
        for value, unit, about in result.facts.values()
    ]
    parts += [text(f"Not checked: {line}") for line in result.not_checked]
    return Group(*parts)


def summary(result: Verification) -> Summary:
    """Return the verdict, and each quantity with its difference and what is allowed."""
    rows = [
        (
            "ok" if c.passed else "FAIL",
            quantity_name(c.name),
            *(f"{x} {unit_text(c.unit)}".rstrip() for x in (f"{c.value:.1e}", f"{c.tolerance:.0e}")),
        )
        for c in result.checks
    ]
    told = " ".join(f"Not checked: {line}." for line in result.not_checked)
    return Summary(sentence(result), told, [(("", "quantity", "difference", "allowed"), rows)])


def sentence(result: Verification) -> str:
    """Return the verdict as one sentence."""
    broken = [quantity_name(c.name) for c in result.checks if not c.passed]
    if not broken:
        return f"{result.model}: all {len(result.checks)} quantities agree."
    return f"{result.model}: {len(broken)} of {len(result.checks)} disagree: {', '.join(broken)}."


def _told(check: Check) -> bool:
    return bool(check.hint) and not check.passed
