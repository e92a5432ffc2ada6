"""What ``workbench identify`` prints, writes and draws."""

from __future__ import annotations

from typing import Any

from rich.console import Group
from rich.text import Text

from workbench.core import FORMAT
from workbench.identification import (
    ActuatorIdentification,
    Fit,
    LegIdentification,
    LinksIdentification,
    axis_rows,
    link_rows,
    links_sentences,
    readable,
)
from workbench.models import Inertial, Model
from workbench.report.layout import table, text, verdict
from workbench.report.numbers import interval


def actuator_dict(found: ActuatorIdentification) -> dict[str, Any]:
    """The JSON of ``identify actuator``."""
    return {
        "format": FORMAT,
        "inertia": found.inertia,
        "damping": found.damping,
        "delay_s": found.delay,
        **_quality(found.fit),
    }


def leg_dict(found: LegIdentification, built: Model) -> dict[str, Any]:
    """The JSON of ``identify leg``."""
    linkage = built.linkage
    return {
        "format": FORMAT,
        "M11": found.M11,
        "M12": found.M12,
        "M22": found.M22,
        "damping": list(found.damping),
        "delay_s": found.delay,
        "gravity": list(found.gravity),
        "postures": [list(f.posture) for f in found.frfs],
        "actuators": {"inertia": list(built.actuators.inertia), "damping": list(built.actuators.damping)},
        "linkage": {} if linkage is None else {k: v for k, v in vars(linkage).items() if k != "identified"},
        **_quality(found.fit),
    }


def actuator_table(found: ActuatorIdentification) -> Group:
    """Estimates with intervals, and whether the model was enough."""
    rows = table("", ("estimate (95 %)", "right"))
    for name, value in (("inertia", found.inertia), ("damping", found.damping), ("delay", found.delay)):
        rows.add_row(name, interval(readable(value)))
    return Group(rows, *_judged(found.fit))


def leg_table(found: LegIdentification, built: Model) -> Group:
    """Total inertia with intervals, whose share it is, and whether the model was enough."""
    rows = table("", ("total (95 %)", "right"), ("actuator", "right"), ("linkage over tree", "right"))
    inertia, linkage = built.actuators.inertia, built.linkage
    assert linkage is not None
    shares = ((inertia[0], linkage.M11), (0.0, linkage.M12), (inertia[1], linkage.M22))
    for name, value, (own, over) in zip(
        ("M11", "M12", "M22"), (found.M11, found.M12, found.M22), shares, strict=True
    ):
        rows.add_row(name, interval(readable(value)), f"{own:.5g}", f"{over:.5g}")
    for name, value in (
        *((f"damping {axis}", d) for axis, d in zip(built.axes, found.damping, strict=True)),
        ("delay", found.delay),
        *((f"gravity {axis}", g) for axis, g in zip(built.axes, found.gravity, strict=True)),
    ):
        rows.add_row(name, interval(readable(value)), "", "")
    return Group(rows, *_judged(found.fit))


def links_dict(found: LinksIdentification, file: str | None) -> dict[str, Any]:
    """The JSON of ``identify links``; `file`: what was written."""
    return {
        "format": FORMAT,
        "model": found.model,
        "file": file,
        "share": found.share,
        "identifiable": found.identifiable,
        "held_out": found.held_out,
        "springs": found.springs,
        "torques": [vars(t) for t in found.torques],
        "links": [
            {
                **{name: getattr(link, name) for name in ("axis", "joint", "body")},
                "before": _inertial(link.before),
                "after": _inertial(link.after),
                "numbers": {name: vars(n) for name, n in link.numbers.items()},
            }
            for link in found.links
        ],
    }


def _inertial(value: Inertial) -> dict[str, Any]:
    return {"mass": value.mass, "centre": value.centre.tolist(), "inertia": value.tensor.tolist()}


def links_table(found: LinksIdentification) -> Group:
    """The torque before and after, and the links."""
    (head, left), (names, links) = axis_rows(found), link_rows(found)
    parts = []
    for columns, rows in ((head, left), (names, links)):
        made = table(columns[0], *((name, "right") for name in columns[1:]))
        for row in rows:
            made.add_row(*row)
        parts.append(made)
    first, *rest = links_sentences(found)
    return Group(verdict(first, found.share > 0.0), *parts, *map(text, rest))


def _judged(fit: Fit) -> list[Text]:
    return [verdict(fit.sentence, fit.adequate), *(text(note) for note in fit.notes)]


def _quality(fit: Fit) -> dict[str, Any]:
    j = fit.judgement
    return {
        "adequate": fit.adequate,
        "sentence": fit.sentence,
        "cost": j.cost,
        "expected_cost": j.expected,
        "cost_std": j.std,
        "correlation": j.correlation,
        "notes": list(fit.notes),
    }
