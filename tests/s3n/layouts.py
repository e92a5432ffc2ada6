"""MJCFs in the layouts of public robot collections: the same two links, said in as many ways."""

from __future__ import annotations

from pathlib import Path

_CORNERS = "v 0 0 0\nv 0.04 0 0\nv 0 0.05 0\nv 0 0 -0.2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
_PNG = bytes.fromhex(
    "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de0000000c49444154789c63f8cfc0000003"
    "010100c9fe92ef0000000049454e44ae426082"
)
_LINKS = """<body name="thigh" pos="0 0 0.8" {thigh}>
<joint name="hip" {hip}/><inertial pos="0 0 -0.09" mass="1.6" diaginertia="0.008 0.008 0.0016"/>{drawn}
<body name="shank" pos="0 0 -0.22" {shank}><joint name="knee" {knee}/>
<inertial pos="0 0.01 -0.1" mass="0.7" diaginertia="0.004 0.004 0.001"/>
<site name="foot" pos="0 0 -0.24"/></body>
{inside}</body>"""
_MESH = '<asset><mesh name="shell" file="{file}"/></asset>'
_SHOWN = '<geom type="mesh" mesh="shell" contype="0" conaffinity="0" mass="0"/>'


def _robot(before: str = "", after: str = "", **parts: str) -> str:
    said = dict.fromkeys(("thigh", "hip", "drawn", "shank", "knee", "inside"), "")
    said |= {"hip": 'axis="0 1 0"', "knee": 'axis="0 1 0"'} | parts
    return f'<mujoco model="r">{before}<worldbody>{_LINKS.format(**said)}</worldbody>{after}</mujoco>'


def _in_world(text: str, inside: str) -> str:
    return text.replace("<worldbody>", f"<worldbody>{inside}", 1)


_HFIELD = '<asset><hfield name="ground" nrow="3" ncol="3" size="1 1 0.1 0.1"/></asset>'
_ATTACHED = """<mujoco model="r"><asset><model name="leg" file="parts/leg.xml"/></asset><worldbody>
<body name="trunk" pos="0 0 1"><geom type="box" size="0.1 0.1 0.05"/>{legs}</body></worldbody></mujoco>"""
_ONE = '<frame pos="0 {y} 0"><attach model="leg" body="thigh" prefix="{side}_"/></frame>'

#: Name of a layout -> its main file.
LAYOUTS: dict[str, str] = {
    "plain": _robot(),
    "nested defaults and childclass": _robot(
        """<default><joint damping="0.1"/><default class="leg">
<joint axis="0 1 0" armature="0.01" range="-1 1"/><default class="knee">
<joint range="0 2" stiffness="3" springref="0.4" frictionloss="0.2"/></default></default></default>""",
        thigh='childclass="leg"',
        hip="",
        knee='class="knee"',
    ),
    "degrees in defaults": _robot(
        """<compiler angle="degree"/><default><joint axis="0 1 0" range="-90 60"/><default class="knee">
<joint range="0 120" springref="20" stiffness="2"/></default></default>""",
        hip="",
        knee='class="knee"',
    ),
    "degrees, ref, euler": _robot(
        '<compiler angle="degree" eulerseq="zyx" autolimits="true"/>',
        hip='axis="0 1 0" range="-90 60"',
        knee='axis="0 1 0" ref="30" range="0 120" springref="20" stiffness="2"',
        shank='euler="0 30 10"',
    ),
    "no autolimits": _robot(
        '<compiler angle="radian" autolimits="false"/>',
        hip='axis="0 1 0" range="-1 1" limited="true"',
        knee='axis="0 1 0" range="-2 2" limited="false"',
    ),
    "meshdir": _robot('<compiler meshdir="meshes"/>' + _MESH.format(file="shell.obj"), drawn=_SHOWN),
    "assetdir and a folder in the name": _robot(
        '<compiler assetdir="."/>' + _MESH.format(file="meshes/shell.obj"), drawn=_SHOWN
    ),
    "strippath": _robot(
        '<compiler meshdir="meshes" strippath="true"/>' + _MESH.format(file="x/shell.obj"), drawn=_SHOWN
    ),
    "textures and materials": _robot(
        """<compiler meshdir="meshes" texturedir="textures"/><asset><mesh name="shell" file="shell.obj"/>
<texture name="skin" type="2d" file="skin.png"/><material name="m" texture="skin"/></asset>""",
        drawn=_SHOWN.replace("/>", ' material="m"/>'),
    ),
    "builtin texture": _robot(
        """<asset><texture name="sky" type="skybox" builtin="gradient" rgb1="1 1 1" rgb2="0 0 0" width="8"
height="8"/></asset>"""
    ),
    "inertia from meshes": _robot(
        '<compiler meshdir="meshes" inertiafromgeom="true"/>' + _MESH.format(file="shell.obj"),
        drawn='<geom type="mesh" mesh="shell"/><geom type="capsule" size="0.02" fromto="0 0 0 0 0 -0.2"/>',
        inside='<body name="cover"><geom type="box" size="0.02 0.02 0.02" mass="0.1"/></body>',
    ).replace('<site name="foot"', '<geom size="0.03"/><site name="foot"'),
    "includes": _robot('<include file="parts/options.xml"/>', '<include file="parts/act.xml"/>'),
    "keyframes and sensors": _robot(
        after="""<sensor><jointpos name="q" joint="hip"/><framepos objtype="site" objname="foot"/></sensor>
<keyframe><key name="home" qpos="0.2 0.5"/><key name="up" qpos="0 1" qvel="0.1 0"/></keyframe>"""
    ),
    "actuators of all kinds": _robot(
        after="""<actuator><motor name="a" joint="hip" ctrlrange="-20 20" gear="2"/>
<position name="knee" joint="knee" kp="30" kv="1" forcerange="-15 15"/>
<general name="c" joint="knee" gainprm="4" biastype="affine" biasprm="0 -4 0"/><velocity joint="hip" kv="2"/>
</actuator><sensor><actuatorfrc actuator="a"/><jointvel joint="hip"/></sensor>
<keyframe><key qpos="0 0.3" ctrl="0 0 0 0"/></keyframe>"""
    ),
    "tendons": _in_world(
        _robot(
            after="""<tendon><fixed name="couple" stiffness="2" damping="0.1"><joint joint="hip" coef="1"/>
<joint joint="knee" coef="-1"/></fixed><spatial name="rope" width="0.01"><site site="foot"/>
<site site="anchor"/></spatial></tendon>"""
        ),
        '<site name="anchor" pos="0.3 0 1"/>',
    ),
    "slide joint": _robot(hip='type="slide" axis="0 0 1" range="-0.1 0.4"'),
    "two joints of one body": _robot().replace(
        '<joint name="hip"', '<joint name="roll" axis="1 0 0" pos="0 0 0.05"/><joint name="hip"'
    ),
    "lights, cameras, visual, statistic": _robot(
        """<visual><headlight diffuse="0.6 0.6 0.6"/></visual><statistic extent="1" center="0 0 0.5"/>""",
        inside='<camera name="eye" pos="0 0 0.1"/><light pos="0 0 1"/>',
    ),
    "a floor and a stand": _in_world(
        _robot(),
        """<geom type="plane" size="1 1 .1"/><body name="stand">
<geom type="box" size="0.1 0.1 0.1" pos="0 0 0.9"/></body>""",
    ),
    "frame and replicate": _in_world(
        _robot(),
        """<frame pos="0.1 0 0" euler="0 0 20"><geom size="0.01"/></frame>
<replicate count="3" offset="0.2 0 0"><geom size="0.02" pos="0 1 0"/></replicate>""",
    ),
    "mocap target": _in_world(
        _robot(after='<keyframe><key name="k" qpos="0 0.2" mpos="1 1 1"/></keyframe>'),
        '<body name="target" mocap="true" pos="1 0 0"><geom size="0.02" contype="0" conaffinity="0"/></body>',
    ),
    "attached model": _ATTACHED.format(legs=_ONE.format(y=0, side="l")),
    "attached twice": _ATTACHED.format(legs=_ONE.format(y=0.3, side="l") + _ONE.format(y=-0.3, side="r")),
    "options and gravity compensation": _robot(
        '<option timestep="0.002" gravity="0 0 -9.7" integrator="RK4"><flag contact="disable"/></option>',
        shank='gravcomp="0.5"',
    ),
    "exclude": _robot(after='<contact><exclude body1="thigh" body2="shank"/></contact>'),
    "height field": _in_world(_robot(_HFIELD), '<geom type="hfield" hfield="ground"/>'),
    "actuatorfrcrange": _robot(hip='axis="0 1 0" actuatorfrcrange="-12 12"'),
    "custom and user data": _robot(
        '<size nuser_jnt="2"/>',
        '<custom><numeric name="n" data="1 2"/><text name="t" data="x"/></custom>',
        hip='axis="0 1 0" user="1 2"',
    ),
    "an equality that is not active": _robot(
        after='<equality><joint joint1="hip" joint2="knee" active="false"/></equality>'
    ),
}

#: Name of a layout that cannot be normalised -> its main file, and what the refusal names.
REFUSED: dict[str, tuple[str, str]] = {
    "a ball joint": (_robot(hip='type="ball"'), "'hip' is a ball"),
    "a free base": (_robot().replace('<joint name="hip" axis="0 1 0"/>', "<freejoint/>"), "floats"),
    "a joint without a name": (_robot().replace('name="knee"', ""), "a joint has no name"),
    "no joints": ('<mujoco><worldbody><geom size="1"/></worldbody></mujoco>', "no joints"),
    "a mesh that is missing": (_robot(_MESH.format(file="lost.obj"), drawn=_SHOWN), "lost.obj"),
    "meshes of elsewhere": (_robot('<compiler meshdir="/usr/share"/>'), "'/usr/share' is not a path"),
    "a weld to a mocap body": (
        _in_world(
            _robot(after='<equality><weld name="w" body1="shank" body2="target"/></equality>'),
            '<body name="target" mocap="true"/>',
        ),
        "'w' (weld)",
    ),
    "a joint that follows": (
        _robot(
            after='<equality><joint name="f" joint1="knee" joint2="hip" polycoef="0 0 1 0 0"/></equality>'
        ),
        "'f' (joint)",
    ),
    "a plugin": (_robot('<extension><plugin plugin="mujoco.elasticity.cable"/></extension>'), "plugin"),
    "an include that is missing": (_robot('<include file="none.xml"/>'), "none.xml"),
}


def lay_out(folder: Path, text: str) -> Path:
    """Write a layout's main file as ``robot.xml`` with all that layouts name; gives its path."""
    for name in ("meshes/x", "textures", "parts"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    for name in ("meshes/shell.obj", "meshes/x/shell.obj"):
        (folder / name).write_text(_CORNERS)
    (folder / "textures" / "skin.png").write_bytes(_PNG)
    (folder / "parts" / "options.xml").write_text('<mujoco><option timestep="0.003"/></mujoco>')
    (folder / "parts" / "act.xml").write_text(
        """<mujoco><actuator><motor name="m" joint="hip" ctrlrange="-3 3"/></actuator>
<sensor><jointpos joint="knee"/></sensor></mujoco>"""
    )
    (folder / "parts" / "leg.xml").write_text(_robot())
    file = folder / "robot.xml"
    file.write_text(text)
    return file
