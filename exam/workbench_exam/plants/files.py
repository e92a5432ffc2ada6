"""A machine as an MJCF and as a URDF file."""

from __future__ import annotations

from collections.abc import Sequence

from .chain import GRAVITY, Machine


def mjcf(machine: Machine) -> str:
    """The machine as an MJCF file; drives that turn with several joints are fixed tendons."""
    lines = [
        f'<mujoco model="{machine.name}">',
        '  <compiler angle="radian"/>',
        f'  <option gravity="0 0 -{GRAVITY}" integrator="implicitfast"/>',
        "  <worldbody>",
    ]
    for depth, link in enumerate(machine.links):
        kind = ' type="slide"' if link.slides else ""
        rotor = "" if machine.couple else " " + _rotor(machine, depth)
        lines += [
            f'{"  " * (depth + 2)}<body name="{link.name}_link" pos="{_row(link.offset)}">',
            f'{"  " * (depth + 3)}<joint name="{link.name}"{kind} axis="{_row(link.axis)}"{rotor}/>',
            f'{"  " * (depth + 3)}<inertial pos="{_row(link.centre)}" mass="{link.mass:.9g}" '
            f'diaginertia="{_row(link.inertia)}"/>',
        ]
    depth = len(machine.links)
    lines.append(f'{"  " * (depth + 2)}<site name="tip" pos="{_row(machine.tip)}"/>')
    lines += [f"{'  ' * (d + 2)}</body>" for d in reversed(range(depth))]
    lines.append("  </worldbody>")
    if machine.couple:
        lines.append("  <tendon>")
        for i, name in enumerate(machine.axes):
            joints = "".join(
                f'<joint joint="{link.name}" coef="{share:.9g}"/>'
                for link, share in zip(machine.links, machine.couple[i], strict=True)
                if share
            )
            lines.append(f'    <fixed name="{name}" {_rotor(machine, i)}>{joints}</fixed>')
        lines.append("  </tendon>")
    turns = "tendon" if machine.couple else "joint"
    motors = "".join(
        f'<motor name="{name}" {turns}="{name}"/>'
        for name, link in zip(machine.axes, machine.links, strict=True)
        if link.driven
    )
    return "\n".join([*lines, f"  <actuator>{motors}</actuator>", "</mujoco>", ""])


def urdf(machine: Machine) -> str:
    """The machine as a URDF file, which has no place for armature nor for coupled drives."""
    lines = ['<?xml version="1.0"?>', f'<robot name="{machine.name}">', '  <link name="base"/>']
    before = "base"
    for link in machine.links:
        kind = "prismatic" if link.slides else "revolute"
        x, y, z = (f"{value:.9g}" for value in link.inertia)
        lines += [
            f'  <link name="{link.name}_link"><inertial><origin xyz="{_row(link.centre)}"/>'
            f'<mass value="{link.mass:.9g}"/>'
            f'<inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="0" ixz="0" iyz="0"/></inertial></link>',
            f'  <joint name="{link.name}" type="{kind}">'
            f'<parent link="{before}"/><child link="{link.name}_link"/>'
            f'<origin xyz="{_row(link.offset)}"/><axis xyz="{_row(link.axis)}"/>'
            '<limit lower="-10" upper="10" effort="1000" velocity="100"/>'
            + (
                ""
                if machine.couple
                else f'<dynamics damping="{link.damping:.9g}" friction="{link.friction:.9g}"/>'
            )
            + "</joint>",
        ]
        before = f"{link.name}_link"
    tip = f'<parent link="{before}"/><child link="tip"/><origin xyz="{_row(machine.tip)}"/>'
    lines += ['  <link name="tip"/>', f'  <joint name="tip" type="fixed">{tip}</joint>', "</robot>", ""]
    return "\n".join(lines)


def _rotor(machine: Machine, i: int) -> str:
    own = machine.links[i]
    return f'damping="{own.damping:.9g}" frictionloss="{own.friction:.9g}" armature="{own.armature:.9g}"'


def _row(values: Sequence[float]) -> str:
    return " ".join(f"{value:.9g}" for value in values)
