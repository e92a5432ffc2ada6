"""workbench: compare a robot model with measurements, find what is missing, add it, watch the error fall.

In short:

    import workbench as wb

    model = wb.load_model("leg")
    recordings = wb.load_recordings(["chirp.toml", "slow.toml"])
    wb.compare(model, recordings)
    better = wb.improve(model, recordings)[1]
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .comparison import compare
    from .diagnosis import diagnose, improve
    from .effects import load_model
    from .inspection import inspect
    from .proposing import import_table
    from .recordings import load_recording, load_recordings, save_recording
    from .simulation import Run, simulate

__all__ = [
    "Run", "compare", "diagnose", "import_table", "improve", "inspect", "load_model", "load_recording",
    "load_recordings", "save_recording", "simulate",
]  # fmt: skip

_HOME = {
    "Run": "simulation",
    "compare": "comparison",
    "diagnose": "diagnosis",
    "import_table": "proposing",
    "improve": "diagnosis",
    "inspect": "inspection",
    "load_model": "effects",
    "load_recording": "recordings",
    "load_recordings": "recordings",
    "save_recording": "recordings",
    "simulate": "simulation",
}


def __getattr__(name: str) -> Any:
    """Import on first use, so that a command that needs little starts fast."""
    if name in _HOME:
        return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


def __dir__() -> list[str]:
    """The public names, which a shell's Tab offers; they are imported on first use."""
    return list(__all__)
