"""A biped as MJCF: each ankle is turned through a crank and a rod, and the shank is a spring."""

from __future__ import annotations

from pathlib import Path

# a leg whose ankle a motor turns through a crank and a rod; at zero crank and rod are in line, a dead point
_LEG = """<body name="{s}_thigh" pos="0 {y} 0"><joint name="{s}_hip" axis="0 1 0" range="-1 1"/>
<geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.03"/>
<body name="{s}_shank" pos="0 0 -0.3"><joint name="{s}_leaf" axis="0 1 0" stiffness="900"/>
<geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.02"/>
<body name="{s}_crank" pos="-0.02 0.03 -0.05"><joint name="{s}_crank" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0 0 -0.04" size="0.006"/>
<body name="{s}_rod" pos="0 0 -0.04"><joint name="{s}_rod" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0 0 -0.2" size="0.004"/></body></body>
<body name="{s}_foot" pos="0 0 -0.3"><joint name="{s}_ankle" axis="0 1 0" range="0.2 0.9" armature="0.01"/>
<geom type="box" size="0.08 0.03 0.01" pos="0.04 0 -0.02"/></body></body></body>"""
BASES = {
    "a free joint": "<freejoint/>",
    "slides and a ball": '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>'
    '<joint type="slide" axis="0 0 1"/><joint type="ball"/>',
}


def biped(folder: Path, base: str = "<freejoint/>") -> Path:
    """Return the file of a biped with two loops, written to a folder."""
    legs = "".join(_LEG.format(s=s, y=y) for s, y in (("left", 0.1), ("right", -0.1)))
    loops = "".join(
        f'<connect body1="{s}_rod" body2="{s}_foot" anchor="0 0 -0.2"/>' for s in ("left", "right")
    )
    motors = "".join(
        f'<motor joint="{s}_{j}" gear="10" ctrlrange="-2 2"/>'
        for s in ("left", "right")
        for j in ("hip", "ankle")
    )
    file = folder / "biped.xml"
    file.write_text(
        f'<mujoco><compiler angle="radian"/><worldbody><body name="pelvis" pos="0 0 0.7">{base}'
        f'<geom type="box" size="0.1 0.1 0.05"/>{legs}</body></worldbody><equality>{loops}</equality>'
        f"<actuator>{motors}</actuator></mujoco>"
    )
    return file
