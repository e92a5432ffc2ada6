"""A leg whose loop is cut, as a URDF that is written out by hand."""

from __future__ import annotations

from collections.abc import Mapping


def urdf_of_a_leg(
    rod: float = 0.2, ranges: Mapping[str, tuple[float, float]] = {}, dynamics: str = ""
) -> str:
    """A leg in URDF, written out by hand: thigh 0.2, shank 0.25 with a rear arm of 0.05.

    With a rod as long as the thigh it is a parallelogram. `ranges` of joints are ±1.5 rad if not given.
    `dynamics` stands in the joints that motors turn.
    """

    def link(name: str, z: float, mass: float, about: float) -> str:
        inertia = f'ixx="{about}" iyy="{about}" izz="{about / 10}" ixy="0" ixz="0" iyz="0"'
        return (
            f'<link name="{name}"><inertial><origin xyz="0 0 {z}"/><mass value="{mass}"/>'
            f"<inertia {inertia}/></inertial></link>"
        )

    def joint(name: str, parent: str, child: str, z: float) -> str:
        low, high = ranges.get(name, (-1.5, 1.5))
        return (
            f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="0 0 {z}"/><axis xyz="0 -1 0"/>'
            f'<limit lower="{low}" upper="{high}" effort="20" velocity="30"/>'
            f"{dynamics if name in ('hip', 'motor') else ''}</joint>"
        )

    def tip(name: str, parent: str, z: float) -> str:
        return (
            f'<link name="{name}"/><joint name="{name}_weld" type="fixed"><parent link="{parent}"/>'
            f'<child link="{name}"/><origin xyz="0 0 {z}"/></joint>'
        )

    parts = [
        '<link name="world"/>',
        link("thigh", -0.1, 1.1, 0.004),
        link("shank", -0.08, 0.3, 0.002),
        link("crank", 0.02, 0.08, 1e-4),
        link("rod", -0.1, 0.06, 2e-4),
        joint("hip", "world", "thigh", 0.0),
        joint("motor", "world", "crank", 0.0),
        joint("knee", "thigh", "shank", -0.2),
        joint("rod_pin", "crank", "rod", 0.05),
        tip("rod_end", "rod", -rod),
        tip("arm_end", "shank", 0.05),
        tip("toe", "shank", -0.25),
    ]
    return f'<robot name="own">{"".join(parts)}</robot>'
