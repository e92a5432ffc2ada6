"""A frequency response on a page: a panel per entry with magnitude, phase and error, and where it is of."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from .numbers import number
from .sheet import Curve, Panel, Row, Section

if TYPE_CHECKING:
    from workbench.frf import Frf


def entry_panels(
    frf: Frf, models: Mapping[str, np.ndarray], *, error: str = "relative error [%]"
) -> list[Panel]:
    """Return a panel for each entry of a measured response, with models (F, ny, nu) by name."""
    half = frf.magnitude_interval()[1] - np.abs(frf.response)
    return [
        response_panel(
            f"{frf.outputs[i].axis} over {frf.inputs[j].axis}",
            f"{frf.outputs[i].unit} / ({frf.inputs[j].unit})",
            frf.frequency,
            frf.response[:, i, j],
            half[:, i, j],
            frf.std[:, i, j],
            {name: g[:, i, j] for name, g in models.items()},
            error=error,
        )
        for i, j in np.ndindex(frf.response.shape[1:])
    ]


def posture_of(frf: Frf) -> str:
    """Return the posture about which it was measured: ``"hip −0.500 rad, knee 1.05 rad"``."""
    axes = dict.fromkeys(o.axis for o in frf.outputs)
    unit = "m" if frf.outputs[0].unit in ("m", "m/s") else "rad"
    return ", ".join(f"{a} {number(x)} {unit}" for a, x in zip(axes, frf.posture, strict=False))


def notes_of(frfs: Iterable[Frf]) -> tuple[Section, ...]:
    """Return what estimation noted, each note once, as the last section of a page; empty without notes."""
    notes = tuple(dict.fromkeys(note for frf in frfs for note in frf.notes))
    return (Section("notes", "Notes", remarks=notes),) if notes else ()


def response_panel(
    title: str,
    unit: str,
    frequency: np.ndarray,
    measured: np.ndarray,
    half: np.ndarray,
    std: np.ndarray,
    models: Mapping[str, np.ndarray],
    *,
    error: str = "relative error [%]",
) -> Panel:
    """Return the panel: measurement with its 95 % band, and models, over one frequency axis.

    Args:
        title: over the panel.
        unit: of the response.
        frequency: [Hz], (F,).
        measured: (F,), complex.
        half: half the 95 % interval of its real (or imaginary) part, (F,).
        std: deviation of the complex number, (F,).
        models: name, which is also the style, to response (F,); phases are unwrapped along the first.
        error: name of the lowest diagram's axis.
    """
    size = np.abs(measured)
    first = next(iter(models.values()), measured)
    guide = np.unwrap(np.angle(first))
    sure = half < size  # beyond that a phase means nothing
    beside = np.where(sure, guide + np.angle(measured / first), np.nan)
    turn = np.arcsin(np.where(sure, half / size, np.nan))
    off = {name: np.abs(g - measured) / size for name, g in models.items()}
    floor = np.maximum(std / size, 1e-9)
    low = 0.3 * min([float(floor.min()), *(float(np.median(e)) for e in off.values())])
    lines = [
        (n, g, np.degrees(guide + np.angle(g / first)), np.maximum(100 * off[n], 100 * low))
        for n, g in models.items()
    ]
    words = ", ".join(f"{words_of(n)} {100 * float(np.sqrt(np.mean(e**2))):.2g} %" for n, e in off.items())
    return Panel(
        title,
        "frequency [Hz]",
        (
            Row(
                f"magnitude [{unit}]",
                (
                    Curve(
                        "uncertainty",
                        "noise",
                        frequency,
                        None,
                        np.maximum(size - half, 0.02 * size),
                        size + half,
                    ),
                    Curve("measured", "measured", frequency, size),
                    *(Curve(words_of(n), n, frequency, np.abs(g)) for n, g, _, _ in lines),
                ),
                log=True,
            ),
            Row(
                "phase [deg]",
                (
                    Curve(
                        "uncertainty", "noise", frequency, None, *np.degrees([beside - turn, beside + turn])
                    ),
                    Curve("measured", "measured", frequency, np.degrees(beside)),
                    *(Curve(words_of(n), n, frequency, phase) for n, _, phase, _ in lines),
                ),
            ),
            error_row(error, frequency, floor, off, low),
        ),
        f"{title}: measured response with its 95 % band{', and models' if models else ''}. Root mean square "
        f"error: {words + '; ' if models else ''}the measurement's own "
        f"{100 * float(np.sqrt(np.mean(floor**2))):.2g} %.",
    )


def error_row(
    label: str, frequency: np.ndarray, floor: np.ndarray, errors: Mapping[str, np.ndarray], low: float
) -> Row:
    """Return relative errors (F,) in percent, over what the measurement's uncertainty explains."""
    bottom = np.full(len(frequency), 100.0 * low)
    return Row(
        label,
        (
            Curve("uncertainty", "noise", frequency, None, bottom, np.maximum(100 * floor, bottom)),
            *(Curve(words_of(n), n, frequency, np.maximum(100 * e, 100 * low)) for n, e in errors.items()),
        ),
        log=True,
    )


#: Names of models as the text writes them.
_WORDS = {
    "closed_chain": "closed chain",
    "kin_only": "Kin-Only",
    "s3n_act": "S3N-Act",
    "s3n_full": "S3N-Full",
    "s3n_full_paper": "S3N-Full (paper)",
}


def words_of(name: str) -> str:
    """Return ``"closed_chain"`` and the variants as they are printed; any other name as it is."""
    return _WORDS.get(name, name)
