"""The control loop over CAN over a bare loop that sends packets and waits for them."""

from __future__ import annotations

from control_loop import bare_loop, tracker
from side_by_side import Ratio, spread

from workbench.can.clock import Clock

from .row import Part, Row

_SLOWER = 10.0  # than real time, for machines that are taken away now and then


def measure(quick: bool) -> list[Row]:
    """Runs of both take turns; times are those of the clock, not CPU times: a loop waits."""
    seconds, repeats = (1.0, 2) if quick else (10.0, 5)
    found: list[tuple[float, float]] = []
    for seed in range(repeats):
        result = tracker(seconds, _SLOWER, seed)
        if result["fault"]:
            raise SystemExit(f"the loop over CAN was ended by a fault: {result['fault']}; is it busy here?")
        trip = result["round_trip_ms"]
        bare = bare_loop(seconds, Clock(_SLOWER))
        found.append((trip["p50"] / (1e3 * bare.percentile(50)), trip["p99"] / (1e3 * bare.percentile(99))))
    middle, late = (spread([pair[k] for pair in found]) for k in (0, 1))
    return [_row("median", middle), _row("99th percentile", late)]


def _row(which: str, ratio: Ratio) -> Row:
    return Row(f"round trip over CAN, 12 motors on 4 buses, {which}", "12 packets over a socket", str(ratio))


PART = Part(
    "loop",
    "The control loop over CAN",
    "Commands to twelve virtual motors on four buses at 1 Mbit/s and their answers, against as many packets "
    "that another process sends back: what is above 1 are buses, whose frames take time, and the package. "
    "Times are those of the clock: a loop waits.",
    measure,
    "python benchmarks/control_loop.py",
)
