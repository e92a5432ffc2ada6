"""Where the measured data lie, and small recordings made for tests."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

_ROOT = Path(__file__).resolve().parents[1]
#: The reference leg from an independent simulator, shipped.
LEG = _ROOT / "examples" / "leg"


def data_folder(name: str) -> Path:
    """A folder of measured data; skips the test where the data are not at hand."""
    root = Path(os.environ.get("WORKBENCH_DATA", _ROOT.parent / "shared" / "data"))
    if not (root / name).exists():
        pytest.skip(f"no measured data at {root / name}; set WORKBENCH_DATA to the folder that has them")
    return root / name


def leg_examples() -> list[Path]:
    """The TOML files of the reference leg's recordings."""
    return sorted(LEG.glob("*/*.toml"))


def emps_toml(folder: Path) -> Path:
    """Write the TOML that describes the EMPS benchmark's MATLAB file; gives its path."""
    table = data_folder("emps") / "DATA_EMPS.mat"
    force = {"column": "vir", "scale": 35.15}
    return write_toml(
        folder / "emps.toml",
        {
            "format": 1,
            "name": "emps",
            "table": str(table.resolve()),
            "rig": "emps",
            "axes": ["slide"],
            "columns": {
                "time": "t",
                "position": "qm",
                "position_reference": "qg",
                "torque_command": force,
                "torque_measured": force,
            },
            "units": {"time": "s", "position": "m", "torque": "N"},
            "controller": {
                "kind": "cascade_pv",
                "kp": 160.18,
                "kv": 243.45,
                "gain": 35.15,
                "limit": 10.0,
                "period_s": 0.001,
            },
            "excitation": {"kind": "reference"},
        },
    )


def write_toml(path: Path, content: dict[str, Any]) -> Path:
    """Write a TOML file; gives its path."""
    path.write_text(tomli_w.dumps(content))
    return path


def two_axes(rows: int = 400, period: float = 0.005) -> dict[str, np.ndarray]:
    """Columns of a small experiment: two driven axes that move, with their derivatives right."""
    t = np.arange(rows) * period
    w = 2 * np.pi * 2.0
    return {
        "t": np.round(t, 9),
        "q_a": 0.3 * np.sin(w * t),
        "q_b": 0.2 * np.cos(w * t),
        "w_a": 0.3 * w * np.cos(w * t),
        "w_b": -0.2 * w * np.sin(w * t),
        "tau_a": np.sin(w * t + 0.3),
        "tau_b": np.cos(w * t + 0.3),
        "ref_a": 0.31 * np.sin(w * t + 0.1),
        "ref_b": 0.21 * np.cos(w * t + 0.1),
    }


def description(**changes: Any) -> dict[str, Any]:
    """The TOML of `two_axes` in ``table.csv``, with top-level keys changed."""
    return {
        "format": 1,
        "name": "made",
        "table": "table.csv",
        "axes": ["a", "b"],
        "columns": {
            "time": "t",
            "position": ["q_a", "q_b"],
            "velocity": ["w_a", "w_b"],
            "torque_measured": ["tau_a", "tau_b"],
            "position_reference": ["ref_a", "ref_b"],
        },
        **changes,
    }


def csv_text(columns: dict[str, Any], end: str = "\n") -> str:
    """Columns as CSV text, floats in full."""
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(_cell(x) for x in row) for row in rows)]
    return end.join(lines) + end


def _cell(value: Any) -> str:
    return value if isinstance(value, str) else repr(float(value))


def write_recording(folder: Path, data: dict[str, Any] | None = None, /, **changes: Any) -> Path:
    """Write ``made.toml`` and ``table.csv``; gives the TOML's path."""
    (folder / "table.csv").write_text(csv_text(two_axes() if data is None else data))
    return write_toml(folder / "made.toml", description(**changes))


def two_mass_recording() -> dict[str, Any]:
    """The TOML of the recording of two inertias on a flexible coupling, as its study has it."""
    from two_mass import description

    return tomllib.loads(description(data_folder("two_mass") / "MultisineTypeA.mat"))


def two_mass(folder: Path) -> tuple[Path, Path]:
    """A rigid model of the two inertias on a flexible coupling, and the TOML of their recording.

    The current stands for the torque, so that inertia and damping are per torque constant.
    """
    content = two_mass_recording()
    for name in ("link_position", "current"):
        del content["columns"][name]
    recording = write_toml(folder / "two_mass.toml", content)
    (folder / "rigid.xml").write_text(
        """<mujoco model="rigid"><worldbody><body name="a">
<joint name="motor" type="hinge" axis="0 0 1"/>
<inertial pos="0 0 0" mass="1e-9" diaginertia="1e-12 1e-12 1e-12"/></body></worldbody></mujoco>"""
    )
    both_masses = {"inertia": [0.00956], "damping": [0.1]}  # of the two, from a fit to the response
    model = {"format": 1, "name": "rigid", "serial": "rigid.xml", "actuators": both_masses}
    return write_toml(folder / "rigid.toml", model), recording


def report_folder(name: str) -> Path:
    """A folder of small inputs that failed; skips the test where they are not at hand."""
    folder = _ROOT.parent / "shared" / "cases" / "reports" / name
    if not folder.exists():
        pytest.skip(f"no inputs at {folder}")
    return folder
