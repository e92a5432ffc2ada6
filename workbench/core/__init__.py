"""Types, units and errors that everything else is built from; imports nothing of workbench."""

from .carried import Carried, CarriedMotion
from .copies import apart, together
from .coupling import Coupling, declared_couplings
from .diagnosis import Diagnosis, Disagreement, Identifiability, Shape, Stopped, Tried, Verdict
from .drive_map import DriveMap
from .errors import InputError, SimulationError, WorkbenchError
from .finding import EffectKey, Estimate, Finding
from .improvement import Improvement, Result, Step
from .mechanism import Mechanism
from .recording import AXIS_SIGNALS, Controller, Excitation, Recording, Recordings, Timing
from .results import (
    FORMAT,
    HOPELESS,
    MARGIN_SIGNAL,
    MARGIN_TOTAL,
    Comparison,
    InverseDynamics,
    Outlier,
    RecordingError,
    Share,
)
from .verification import Check, Verification

__all__ = [
    "AXIS_SIGNALS", "FORMAT", "HOPELESS", "MARGIN_SIGNAL", "MARGIN_TOTAL",
    "Carried", "CarriedMotion", "Check", "Comparison", "Controller",
    "Coupling", "Diagnosis", "Disagreement", "DriveMap", "EffectKey", "Estimate", "Excitation", "Finding",
    "Identifiability", "Improvement", "InputError", "InverseDynamics", "Mechanism", "Outlier", "Recording",
    "RecordingError", "Recordings", "Result", "Shape", "Share", "SimulationError", "Step", "Stopped",
    "Timing", "Tried", "Verdict", "Verification", "WorkbenchError", "apart", "declared_couplings", "together",
]  # fmt: skip
