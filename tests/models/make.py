"""Model files made for tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tests.data_helpers import write_toml
from workbench.core.paths import models_folder

#: Three joints, of two kinds, with everything that a user's file may hold and a recording replaces.
MACHINE_XML = """
<mujoco model="machine">
  <compiler angle="radian" autolimits="true"/>
  <option gravity="0 0 -9.81" integrator="implicitfast" timestep="0.004"/>
  <default><joint damping="0.3" armature="0.02"/></default>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 0.1"/>
    <body name="rail" pos="0 0 1">
      <joint name="rail" type="slide" axis="1 0 0" damping="4.0" armature="0.5"/>
      <geom name="rail" type="box" size="0.1 0.1 0.05" mass="3"/>
      <body name="boom">
        <joint name="boom" type="hinge" axis="0 -1 0"/>
        <geom name="boom" type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" mass="1.2"/>
        <body name="hook" pos="0 0 -0.4">
          <joint name="hook" type="slide" axis="0 0 -1" range="0 0.3" stiffness="200" springref="0.02"/>
          <geom name="hook" type="sphere" size="0.05" mass="0.6"/>
          <site name="grip" pos="0 0 -0.05"/>
        </body>
      </body>
    </body>
  </worldbody>
  <tendon><fixed name="cable" frictionloss="0.05"><joint joint="boom" coef="1"/></fixed></tendon>
  <actuator>
    <motor name="m_rail" joint="rail" gear="10"/>
    <position name="m_boom" joint="boom" kp="500"/>
  </actuator>
  <sensor><jointpos joint="boom"/><actuatorfrc actuator="m_rail"/></sensor>
  <keyframe><key name="home" qpos="0.5 0.2 0.1" ctrl="1 2"/></keyframe>
</mujoco>
"""


def leg_table(**changes: Any) -> dict[str, Any]:
    """The reference leg's model file as nested tables, without effects, with top-level keys changed."""
    table: dict[str, Any] = {
        "format": 1,
        "name": "made",
        "serial": "serial/leg.xml",
        "variant": "exact",
        "axes": ["hip", "knee"],
        "transmission": {"joints": ["hip", "knee"], "matrix": [[1.0, 0.0], [1.0, 1.0]]},
        "actuators": {
            "inertia": [0.0162, 0.0162],
            "damping": [0.0972, 0.0972],
            "torque_limit": [24.0, 24.0],
            "delay_s": 0.003,
        },
        "controller": {
            "kind": "pd",
            "coordinates": "joint",
            "kp": [50.0, 50.0],
            "kd": [1.5, 1.5],
            "period_s": 0.003,
        },
        "linkage": {
            "M11": 0.00967,
            "M12": 0.002893,
            "M22": 0.00516,
            "g1": 0.163091,
            "g2": 0.132743,
            "identified": True,
        },
        "payload": {"site": "foot"},
    }
    table.update(changes)
    return {key: value for key, value in table.items() if value is not None}


def leg_file(folder: Path, **changes: Any) -> Path:
    """Write `leg_table` as ``made.toml``; gives its path."""
    return write_toml(folder / "made.toml", leg_table(**changes))


def machine_file(folder: Path) -> Path:
    """Write `MACHINE_XML` as ``machine.xml``; gives its path."""
    path = folder / "machine.xml"
    path.write_text(MACHINE_XML)
    return path


def leg_in_pieces(folder: Path) -> Path:
    """The reference leg with an MJCF that includes a file and has two meshes of one name; gives its path."""
    own = folder / "tree"
    for name, edge in (("thin", 0.1), ("wide", 0.2)):
        (own / "meshes" / name).mkdir(parents=True)
        corners = "".join(f"v {x} {y} {z}\n" for x, y, z in [(0, 0, 0), (edge, 0, 0), (0, 1, 0), (0, 0, 1)])
        (own / "meshes" / name / "link.obj").write_text(f"{corners}f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    (own / "parts").mkdir()
    (own / "parts" / "option.xml").write_text('<mujoco><option timestep="0.002"/></mujoco>')
    meshes = "".join(f'<mesh name="{name}" file="{name}/link.obj"/>' for name in ("thin", "wide"))
    drawn = f'<compiler meshdir="meshes"/><include file="parts/option.xml"/><asset>{meshes}</asset>'
    text = (models_folder() / "serial" / "leg.xml").read_text()
    (own / "leg.xml").write_text(text.replace("<worldbody>", f"{drawn}<worldbody>", 1))
    return leg_file(folder, serial="tree/leg.xml")
