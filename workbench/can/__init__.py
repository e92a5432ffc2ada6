"""CAN: the protocols of drives, the buses, their load, and a model of a bus."""

from .config import load_config
from .damiao import Damiao
from .dbc import dbc
from .frame import Frame, FrameError, frame_bits, worst_bits
from .load import MOST, BusLoad, bus_load
from .messages import Fault, Feedback, Parameter, Ranges, Read, Setpoint
from .mit import Mit
from .problems import range_problems
from .robstride import Robstride
from .span import Span
from .tables import CanConfig, Drive, MotorTable, make_drive
from .wire import Wire

__all__ = [
    "MOST", "BusLoad", "CanConfig", "Damiao", "Drive", "Fault", "Feedback", "Frame", "FrameError", "Mit",
    "MotorTable", "Parameter", "Ranges", "Read", "Robstride", "Setpoint", "Span", "Wire", "bus_load", "dbc",
    "frame_bits", "load_config", "make_drive", "range_problems", "worst_bits",
]  # fmt: skip
