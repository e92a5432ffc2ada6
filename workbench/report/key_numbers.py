"""The few most important numbers of a result, as its page shows them first."""

from __future__ import annotations

from workbench.core import Comparison, Diagnosis, Result

from . import wording as w
from .ladder import rungs
from .numbers import number, percent


def key_numbers(result: Result) -> list[tuple[str, str, str]]:
    """Return label, number and remark of the most important numbers."""
    if isinstance(result, Comparison):
        spread = result.noise_error_std
        note = f"± {number(2 * spread, 2)} from run to run" if spread > 0 else "what a perfect model scores"
        times = w.times_noise(result.error, result.noise_error)
        return [
            ("Error", number(result.error), f"{times} the noise floor" if times else ""),
            ("Noise floor", number(result.noise_error), note),
            ("Recordings", str(len(result.recordings)), _duration(result)),
        ]
    last = rungs(result)[-1]
    before = rungs(result)[0]
    times = w.times_noise(last.error, result.noise_error)
    out = [
        (
            "Error before",
            number(before.error),
            f"{w.times_noise(before.error, result.noise_error)} the noise floor",
        ),
        ("Error after", number(last.error), f"{times} the noise floor" if times else ""),
        ("Noise floor", number(result.noise_error), "what a perfect model scores"),
    ]
    out = out if len(rungs(result)) > 1 else [("Error", *out[0][1:]), out[2]]
    if isinstance(result, Diagnosis):
        out.append(
            ("Unexplained", percent(result.unexplained_fraction), "of the squared error above the noise")
        )
    elif result.holdout_error_after is not None:
        out.append(
            (
                "Held-out error",
                number(result.holdout_error_after),
                f"before {number(result.holdout_error_before)}",
            )
        )
    return out


def _duration(result: Comparison) -> str:
    total = sum(r.covers or r.recording.duration for r in result.recordings)
    return f"{number(total)} s of data"
