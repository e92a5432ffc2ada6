"""One entry of a frequency response as a panel: magnitude, phase and error of measurement and models."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .sheet import Curve, Panel, Row


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
    first = next(iter(models.values()))
    guide = np.unwrap(np.angle(first))
    sure = half < size  # beyond that a phase means nothing
    beside = np.where(sure, guide + np.angle(measured / first), np.nan)
    turn = np.arcsin(np.where(sure, half / size, np.nan))
    off = {name: np.abs(g - measured) / size for name, g in models.items()}
    floor = np.maximum(std / size, 1e-9)
    low = 0.3 * min(float(floor.min()), *(float(np.median(e)) for e in off.values()))
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
        f"{title}: measured response with its 95 % band, and models. Root mean square error: {words}; "
        f"the measurement's own {100 * float(np.sqrt(np.mean(floor**2))):.2g} %.",
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
