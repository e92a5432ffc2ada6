"""Experiments and policies on hardware over CAN: safety, the loop, recorder and runner."""

from .controller import Controller, Target
from .feedback import Feedback
from .host import Host
from .joints import Joints, joints_of
from .limits import Limits, limits_of
from .network import Arrival, Network
from .operator import Operator
from .safety import SafetyState, Seen, Setpoints, Wanted, initial, step
from .simulated import SimulatedNetwork
from .statistics import Punctuality
from .verify import Verified, VerifyError, verify

__all__ = [
    "Arrival",
    "Controller",
    "Feedback",
    "Host",
    "Joints",
    "Limits",
    "Network",
    "Operator",
    "Punctuality",
    "SafetyState",
    "Seen",
    "Setpoints",
    "SimulatedNetwork",
    "Target",
    "Verified",
    "VerifyError",
    "Wanted",
    "initial",
    "joints_of",
    "limits_of",
    "step",
    "verify",
]
