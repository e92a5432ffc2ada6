"""The page of ``workbench check``: quantities, inertia of variants, stability of explicit injection."""

from __future__ import annotations

import numpy as np

from workbench.core import Verification

from .numbers import number, unit_text
from .response import words_of
from .sheet import Curve, Drawing, Panel, Row, Section, Sheet, SheetTable
from .verification import quantity_name, sentence


def verification_sheet(result: Verification) -> Sheet:
    """Return the page of a verification."""
    broken = [c for c in result.checks if not c.passed]
    closest = max(
        result.checks, key=lambda c: c.value / c.tolerance if c.tolerance > 0 else 0.0, default=None
    )
    name, margin = "–", ""
    if closest is not None:
        name, margin = quantity_name(closest.name), f"{closest.value:.1e} of {closest.tolerance:.0e} allowed"
    stable = ()
    if len(result.radius):
        top = float(np.max(result.radius))
        stable = (
            (
                "Explicit injection",
                number(top),
                "spectral radius; unstable" if top >= 1 else "spectral radius; stable",
            ),
        )
    return Sheet(
        kind="check",
        model=result.model,
        tone="consistent" if result.passed else "missing_effect",
        sentence=sentence(result),
        lines=tuple(f"{quantity_name(c.name)}: {c.hint}." for c in broken if c.hint)[:3],
        key_numbers=(
            ("Agree", f"{len(result.checks) - len(broken)} of {len(result.checks)}", "quantities"),
            ("Closest to its limit", name, margin),
            *stable,
        ),
        sections=(_checks(result), *_masses(result), *_radius(result), *_stated(result)),
    )


def _checks(result: Verification) -> Section:
    rows = tuple(
        (
            quantity_name(c.name),
            "ok" if c.passed else "FAILS",
            f"{c.value:.1e}" if c.value else "0",
            f"{c.tolerance:.0e}",
            unit_text(c.unit) or "relative",
            c.about,
        )
        for c in result.checks
    )
    table = SheetTable(
        "Largest difference between the engines of the last column, and the largest difference allowed",
        ("Quantity", "Result", ">Difference", ">Allowed", "Unit", "Between"),
        rows,
    )
    hints = tuple(f"{quantity_name(c.name)}: {c.hint}" for c in result.checks if c.hint and not c.passed)
    return Section("checks", "What was checked", tables=(table,), remarks=hints)


def _masses(result: Verification) -> tuple[Section, ...]:
    if not result.variants:
        return ()
    rows = tuple((words_of(name), *(f"{v:.5f}" for v in values)) for name, values in result.variants.items())
    header = ("Variant", ">M11 [kg m²]", ">M12 [kg m²]", ">M22 [kg m²]")
    table = SheetTable("Mass matrix at alpha = 90°, serial coordinates", header, rows)
    return (Section("variants", "Inertia of the variants", tables=(table,)),)


def _radius(result: Verification) -> tuple[Section, ...]:
    if not len(result.radius):
        return ()
    alpha = np.asarray(result.alpha_deg, float)
    low, high = float(np.min(result.radius)), float(np.max(result.radius))
    panel = Panel(
        "Spectral radius over posture",
        "angle between the links, alpha [deg]",
        (
            Row(
                "spectral radius",
                (
                    Curve("explicit injection", "fit", alpha, np.asarray(result.radius, float)),
                    Curve("limit of stability", "limit", alpha, np.ones(len(alpha))),
                ),
            ),
        ),
        f"The spectral radius of explicit injection is {number(low)} to {number(high)} over the knee angle "
        "alpha; it is stable below 1.",
        log=False,
    )
    text = (
        "The paper adds the coupling as a torque that is computed from the acceleration of the last step. In "
        "every step the error of this acceleration is multiplied by the spectral radius: below 1 it "
        "decreases, otherwise it grows."
    )
    drawing = Drawing((panel,), "Spectral radius of explicit injection over the angle between the links.")
    return (Section("explicit", "Explicit injection", (text,), drawings=(drawing,)),)


def _stated(result: Verification) -> tuple[Section, ...]:
    lines = [
        f"{about} {number(v)} {unit_text(unit)}".rstrip() + "." for v, unit, about in result.facts.values()
    ]
    lines += [f"Not checked: {line}" for line in result.not_checked]
    return (Section("stated", "Reported, but not checked", remarks=tuple(lines)),) if lines else ()
