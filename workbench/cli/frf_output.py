"""What ``workbench frf`` prints and writes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from rich.console import Group, RenderableType

from workbench.core import FORMAT
from workbench.models import Model
from workbench.report.layout import table, text
from workbench.verification import FrfComparison


def frf_table(found: Sequence[FrfComparison]) -> Group:
    """One table per posture: how far every model is from the measurement, and where most."""
    parts: list[RenderableType] = []
    for c in found:
        frf = c.frf
        where = ", ".join(f"{x:.3g}" for x in frf.posture)
        parts.append(
            text(
                f"Posture {where}: {len(frf)} lines, {frf.frequency[0]:.3g} to {frf.frequency[-1]:.3g} "
                f"Hz, {frf.periods} periods; the measurement's own uncertainty is "
                f"{100 * c.overall_noise:.2g} %."
            )
        )
        rows = table("model", ("relative error", "right"), ("x uncertainty", "right"), ("worst at", "right"))
        for name in c.models:
            ratio = c.overall(name) / c.overall_noise if c.overall_noise > 0 else float("nan")
            rows.add_row(name, f"{100 * c.overall(name):.3g} %", f"{ratio:.3g}", f"{c.worst(name):.3g} Hz")
        parts.append(rows)
        parts += [text(note) for note in frf.notes]
    return Group(*parts)


def frf_dict(model: Model, found: Sequence[FrfComparison]) -> dict[str, Any]:
    """The JSON of ``frf``: responses as real and imaginary parts, entry by entry."""
    return {
        "format": FORMAT,
        "model": model.name,
        "postures": [
            {
                "posture": list(c.frf.posture),
                "inputs": [str(channel) for channel in c.frf.inputs],
                "outputs": [str(channel) for channel in c.frf.outputs],
                "frequency_hz": c.frf.frequency,
                "measured": _parts(c.frf.response),
                "std": c.frf.std,
                "models": {
                    name: {**_parts(g), "relative_error": c.overall(name), "worst_hz": c.worst(name)}
                    for name, g in c.models.items()
                },
                "relative_noise": c.overall_noise,
                "periods": c.frf.periods,
                "method": c.frf.method,
                "notes": list(c.frf.notes),
            }
            for c in found
        ],
    }


def _parts(response: np.ndarray) -> dict[str, Any]:
    return {"real": response.real, "imag": response.imag}
