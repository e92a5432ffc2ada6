"""Experiments and policies on hardware over CAN: safety, the loop, recorder and runner.

What a robot's own computer needs imports no simulator; virtual motors in simulated time are loaded when used.
"""

from typing import TYPE_CHECKING, Any

from .controller import Target
from .feedback import Feedback
from .host import Host
from .joints import Joints, joints_of
from .limits import Limits, limits_of
from .safety import SafetyState, initial, step
from .seen import Seen, Setpoints, Wanted
from .statistics import Punctuality
from .verify import VerifyError

if TYPE_CHECKING:
    from .simulated import SimulatedNetwork

__all__ = [
    "Feedback", "Host", "Joints", "Limits", "Punctuality", "SafetyState", "Seen", "Setpoints",
    "SimulatedNetwork", "Target", "VerifyError", "Wanted", "initial", "joints_of", "limits_of", "step",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name == "SimulatedNetwork":
        from .simulated import SimulatedNetwork

        return SimulatedNetwork
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
