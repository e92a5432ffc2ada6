"""The pages of ``workbench identify``: estimates, the fit with what it leaves, and whether it was enough."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.core import Estimate
from workbench.frf import Frf
from workbench.models import Model
from workbench.report.numbers import interval, number, unit_text
from workbench.report.response import entry_panels, notes_of, posture_of
from workbench.report.sheet import Drawing, Section, Sheet, SheetTable

from .fit import Fit
from .result import ActuatorIdentification, LegIdentification

_DRAWN = 6  # postures


def readable(value: Estimate) -> Estimate:
    """Seconds as milliseconds."""
    return Estimate(1e3 * value.value, 1e3 * value.std, "ms") if value.unit == "s" else value


def actuator_sheet(found: ActuatorIdentification) -> Sheet:
    """Return a drive's inertia, damping and delay."""
    rows = actuator_rows(found)
    table = SheetTable("Estimates, with 95 % intervals", ("Parameter", ">Estimate"), rows)
    said = ", ".join(f"{name.lower()} {text}" for name, text in rows)
    axis = found.frf.inputs[0].axis
    return _sheet(axis, f"The drive has {said} (95 %)", rows, table, found.fit, (found.frf,))


def actuator_rows(found: ActuatorIdentification) -> tuple[tuple[str, str], ...]:
    """Return each number of a drive by name, with its 95 % interval."""
    values = (("Inertia", found.inertia), ("Damping", found.damping), ("Delay", found.delay))
    return tuple((name, interval(readable(v))) for name, v in values)


def leg_sheet(found: LegIdentification, built: Model) -> Sheet:
    """Return a leg's total inertia, the actuators' share, and what is the linkage's over the serial tree."""
    own, linkage = built.actuators.inertia, built.linkage
    assert linkage is not None
    totals = (("M11", found.M11), ("M12", found.M12), ("M22", found.M22))
    shares = ((own[0], linkage.M11), (0.0, linkage.M12), (own[1], linkage.M22))
    rows = [
        (name, interval(readable(v)), *(f"{number(x, 4)} {unit_text(v.unit)}" for x in (a, over)))
        for (name, v), (a, over) in zip(totals, shares, strict=True)
    ]
    others = (
        *((f"damping {axis}", d) for axis, d in zip(built.axes, found.damping, strict=True)),
        ("delay", found.delay),
        *((f"gravity {axis}", g) for axis, g in zip(built.axes, found.gravity, strict=True)),
    )
    rows += [(name, interval(readable(v)), "", "") for name, v in others]
    table = SheetTable(
        "Total (95 % intervals), the actuators' share of it, and what the linkage adds to the serial tree",
        ("Parameter", ">Total", ">Actuator", ">Linkage over tree"),
        tuple(rows),
    )
    key = tuple((name, interval(v)) for name, v in totals)
    said = ", ".join(f"{name} {text}" for name, text in key)
    said = f"The leg has a total inertia of {said} (95 %)"
    return _sheet(built.name, said, key, table, found.fit, found.frfs)


def _sheet(
    name: str, said: str, key: Sequence[tuple[str, str]], table: SheetTable, fit: Fit, frfs: Sequence[Frf]
) -> Sheet:  # fmt: skip
    j = fit.judgement
    judged = SheetTable(
        "The residual of the fit, weighted by the measured covariances, and the residual that a "
        "correct model would have",
        ("Test", ">Found", ">Expected", ">Deviation", "Passed"),
        (
            ("size", number(j.cost), number(j.expected), number(j.std), "yes" if j.size_fine else "no"),
            (
                "correlation from line to line",
                number(j.correlation),
                "0",
                number(j.correlation_std),
                "yes" if j.white else "no",
            ),
        ),
    )
    return Sheet(
        kind="identification",
        model=name,
        tone="consistent" if fit.adequate else "unexplained",
        sentence=f"{said}; the model {'' if fit.adequate else 'only partly '}explains the response.",
        lines=(fit.sentence,),
        key_numbers=(
            *((label, text.split(" ± ")[0], f"± {text.split(' ± ')[1]}" if " ± " in text else "")
              for label, text in key),
            ("Residual", f"{number(j.cost / j.expected)} ×", "what noise alone gives"),
        ),
        sections=(
            Section("estimates", "Estimates", tables=(table,)),
            Section("judgement", "Does the model explain the response?", tables=(judged,), remarks=fit.notes),
            *_responses(fit, frfs),
            *notes_of(frfs),
        ),
    )  # fmt: skip


def _responses(fit: Fit, frfs: Sequence[Frf]) -> list[Section]:
    """The measured response (with its own covariance, not the pooled weights) and the fit, by posture."""
    out = []
    for k, (frf, model) in enumerate(zip(frfs, fit.responses, strict=True)):
        if k == _DRAWN:
            break
        panels = tuple(entry_panels(frf, {"fit": model}, error="residual [%]"))
        caption = (
            f"From {frf.inputs[0].signal.replace('_', ' ')} to {frf.outputs[0].signal}; about "
            f"{posture_of(frf)}. Grey: 95 % of the measured magnitude and phase, and under the residual the "
            f"measurement's own uncertainty. {len(frf)} lines, {frf.periods} periods."
        )
        title = "Response, fit and residual" + (f", posture {k + 1}" if len(frfs) > 1 else "")
        out.append(Section(f"response-{k + 1}", title, drawings=(Drawing(panels, caption),)))
    return out
