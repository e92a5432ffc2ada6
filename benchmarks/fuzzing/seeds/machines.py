"""A model, a plain robot file, and the drives of a robot on a bus."""

from __future__ import annotations

import shutil
from pathlib import Path

import tomli_w

from workbench.core.paths import models_folder

from .tables import AXES


def model(folder: Path) -> None:
    """The reference leg with effects of several forms in it, its files beside it."""
    shipped = models_folder()
    text = (shipped / "leg.toml").read_text().replace("serial/", "").replace("closed_chain/", "")
    effects = [
        ("viscous_damping", "hip", {"damping": 0.05}),
        ("coulomb_friction", "knee", {"torque": {"value": 0.2, "std": 0.01, "unit": "N*m"}}),
        ("cogging", "hip", {"torque": 0.05, "order": 12.0, "phase": 0.3}),
    ]
    text += tomli_w.dumps(
        {
            "effects": [
                {"effect": e, "axis": a, "location": "actuator", "parameters": p} for e, a, p in effects
            ]
        }
    )
    (folder / "leg.toml").write_text(text)
    shutil.copy(shipped / "serial" / "leg.xml", folder)
    shutil.copy(shipped / "closed_chain" / "leg.sdf", folder)


def urdf(folder: Path) -> None:
    """A leg of two links, one of them closing a loop, as URDF."""
    link = (
        '<link name="{0}"><inertial><origin xyz="0 0 -0.1"/><mass value="1"/><inertia ixx="0.01" iyy="0.01" '
        'izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )
    joint = (
        '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="0 0 {3}"/>'
        '<axis xyz="0 -1 0"/><limit lower="-1.5" upper="2.5" effort="9" velocity="9"/></joint>'
    )
    parts = [link.format(name) for name in ("thigh", "shank")]
    parts += [joint.format("hip", "world", "thigh", 0), joint.format("knee", "thigh", "shank", -0.2)]
    (folder / "leg.urdf").write_text(f'<robot name="leg"><link name="world"/>{"".join(parts)}</robot>')


def can_config(folder: Path) -> None:
    """Two drives on a bus between processes."""
    motors = [
        {
            "axis": axis, "bus": "can0", "protocol": "damiao", "id": i + 1, "reply_id": 17 + i,
            "ranges": {"position": 12.5, "velocity": 45.0, "torque": 25.0, "source": "of the virtual drives"},
            "limits": {"position": [-3.0, 3.0], "velocity": 40.0, "torque": 20.0},
        }
        for i, axis in enumerate(AXES)
    ]  # fmt: skip
    content = {
        "format": 1, "name": "leg", "machine": "0123456789abcdef",
        "bus": [{"name": "can0", "interface": "workbench", "channel": "can0.sock"}], "motor": motors,
        "mechanism": [{"model": "leg", "axes": list(AXES)}],
        "loop": {"period_s": 0.003, "kp": [50.0, 50.0], "kd": [1.5, 1.5], "pd": "host"},
        "imu": {"bus": "can0", "id": 0x60},
        "bench": {"rig": "legs"},
    }  # fmt: skip
    (folder / "robot.toml").write_text(tomli_w.dumps(content))
