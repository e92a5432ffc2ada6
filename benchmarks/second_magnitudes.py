"""Finds the smallest size of each effect of the second leg that doubles the nominal model's error.

    python benchmarks/second_magnitudes.py            # prints the table of exam/second/sizes.py

As `hidden_magnitudes.py`, over the second leg's motions.
"""

from __future__ import annotations

import argparse
from functools import lru_cache

import numpy as np
from exam.second.hidden import Hidden
from exam.second.leg import SILENT, SecondLeg
from exam.second.motions import motions
from exam.second.shapes import Draw, Seat, hidden_of
from exam.second.sizes import SEATS, SMALLEST
from hidden_magnitudes import BESIDE, LATE, RATIO, SIGNALS, SIGNALS_OF_LATE, normalised_error

from workbench.core import Recording, SimulationError

_SEED = 0
_NEAR = 0.1  # how near the wanted error is near enough


def main() -> None:
    """Prints the table, one line a place."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("effects", nargs="*", help="default: all")
    wanted = parser.parse_args().effects
    for seat in SEATS:
        if not wanted or seat[0] in wanted:
            print(f"    {seat!r}: {smallest(seat):.2g},", flush=True)


def smallest(seat: Seat, tries: int = 12) -> float:
    """Size at which the effect alone is sqrt(RATIO^2 - 1) times the noise; by secant in log-log.

    A size with which the leg runs away is halved, one that does not show at all is made half as large again.
    """
    signals = tuple(SIGNALS_OF_LATE if seat[0] in LATE else SIGNALS)
    truth, goal = _recorded(), _noise(signals) * np.sqrt(RATIO**2 - 1)
    if seat[0] in BESIDE:
        truth = _run(hidden_of(seat, 0.0, Draw()))
    size, power, last = SMALLEST.get(seat, 0.1), 1.0, None
    for _ in range(tries):
        try:
            error = normalised_error(_run(hidden_of(seat, size, Draw())), truth, signals)
        except SimulationError:
            size *= 0.5
            continue
        if error < 1e-6:
            size *= 1.5
            continue
        if abs(error / goal - 1) < _NEAR:
            break
        if last is not None and size != last[0]:
            power = float(np.clip(np.log(error / last[1]) / np.log(size / last[0]), 0.3, 8.0))
        last = (size, error)
        size *= float(np.clip((goal / error) ** (1 / power), 0.1, 10.0))
    return size


@lru_cache(maxsize=1)
def _recorded() -> list[Recording]:
    return _run()


@lru_cache(maxsize=2)
def _noise(signals: tuple[str, ...]) -> float:
    return normalised_error(SecondLeg(seed=_SEED).run(motions(_SEED)), _recorded(), signals)


def _run(*hidden: Hidden) -> list[Recording]:
    return SecondLeg(hidden, _SEED, SILENT).run(motions(_SEED))


if __name__ == "__main__":
    main()
