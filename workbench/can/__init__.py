"""CAN: what drives understand, exactly; the bus, its load, and a model of it."""

from .damiao import Damiao
from .dbc import dbc
from .frame import Frame, FrameError, frame_bits, worst_bits
from .messages import Fault, Feedback, Parameter, Ranges, Read, Setpoint
from .mit import Mit
from .robstride import Robstride
from .span import Span

__all__ = [
    "Damiao",
    "Fault",
    "Feedback",
    "Frame",
    "FrameError",
    "Mit",
    "Parameter",
    "Ranges",
    "Read",
    "Robstride",
    "Setpoint",
    "Span",
    "dbc",
    "frame_bits",
    "worst_bits",
]
