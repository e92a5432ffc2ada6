"""A model as notebooks show it: drives and effects, and the links in the zero posture."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from workbench.core.palette import LINES
from workbench.core.picture import Picture, printed
from workbench.core.shown import Summary

from .model import Model
from .serial import joint_kinds
from .skeleton import Skeleton

_SLIM = 0.5  # least width of the box of links over its largest: numbers on a slimmer one overlap

#: Of inertia, damping and limit, where the joint turns and where it slides.
_UNITS = {"hinge": ("kg m²", "N m s/rad", "N m"), "slide": ("kg", "N s/m", "N")}


def summary(model: Model) -> Summary:
    """Return drives, what the file states of its joints, and effects."""
    a = model.actuators
    kinds = joint_kinds(model)
    units = [_UNITS[kinds[int(row.argmax())]] for row in np.abs(model.transmission)]
    drives = zip(model.axes, zip(a.inertia, a.damping, a.torque_limit, strict=True), units, strict=True)
    effects = [
        (
            str(e.key),
            ", ".join(f"{n} = {_number(x.value, _printed(x.unit))}" for n, x in e.parameters.items()),
        )
        for e in model.effects
    ]
    head = ("drive", "inertia", "damping", "limit")
    tables = [
        (head, [(name, *map(_number, numbers, of)) for name, numbers, of in drives if _says(numbers)]),
        (("joint of the file", "armature", "damping", "dry friction"), _stated(model)),
        (("effect", "parameters"), effects),
    ]
    told = (
        f"{model.serial.name} with axes {', '.join(model.axes)}; delay {1e3 * a.delay_s:.3g} ms; "
        f"loop: {model.controller.kind}"
    )
    return Summary(model.name, told if effects else f"{told}; no effects", tables)


def _says(numbers: tuple[float, ...]) -> bool:
    """Return whether a drive has an inertia, damping or limit."""
    return any(0.0 < x < np.inf for x in numbers)


def _stated(model: Model) -> list[tuple[str, ...]]:
    """Return what the MJCF or URDF states of a joint beside its links, if anything."""
    tree = Skeleton.of(model.serial).spec
    rows = []
    for joint, kind in zip(model.joints, joint_kinds(model), strict=True):
        dof = tree.jnt_dofadr[tree.joint(joint).id]
        numbers = [float(x[dof]) for x in (tree.dof_armature, tree.dof_damping, tree.dof_frictionloss)]
        if any(numbers):
            rows.append((joint, *map(_number, numbers, _UNITS[kind])))
    return rows


def as_figure(model: Model) -> Figure:
    """Return a figure of the serial tree's links in its zero posture, to scale."""
    skeleton = Skeleton.of(model.serial)
    data = mujoco.MjData(skeleton.spec)
    mujoco.mj_kinematics(skeleton.spec, data)
    figure = Picture(figsize=(4.6, 4.6))
    axes: Any = figure.add_axes((0.02, 0.04, 0.9, 0.88), projection="3d")
    style = LINES["closed_chain"]
    drawn = []
    for body, ends in zip(skeleton.body, skeleton.ends, strict=True):
        points = ends @ data.xmat[body].reshape(3, 3).T + data.xpos[body]
        axes.plot(*points.T, "-o", color=style.light, lw=3, ms=5)
        drawn.append(points)
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    axes.set_title(printed(model.name), fontsize=10)
    _to_scale(axes, np.concatenate(drawn))
    return figure


def _to_scale(axes: Any, points: np.ndarray) -> None:
    """Return a box around points (N, 3) with room for the numbers on its edges."""
    low, high = points.min(axis=0), points.max(axis=0)
    wide = np.maximum(1.1 * (high - low), _SLIM * float(np.ptp(points, axis=0).max()))
    middle = 0.5 * (low + high)
    axes.set(**{f"{n}lim": (m - 0.5 * w, m + 0.5 * w) for n, m, w in zip("xyz", middle, wide, strict=True)})
    axes.set_box_aspect(wide, zoom=0.82)
    for axis, width in zip((axes.xaxis, axes.yaxis, axes.zaxis), wide, strict=True):
        axis.set_major_locator(MaxNLocator(3 if width < 0.8 * wide.max() else 5))
        axis.labelpad = 12 if axis is axes.zaxis else 7  # its numbers stand beside it, not below
    axes.tick_params(labelsize=8)


def _number(value: float, unit: str) -> str:
    return f"{value:.4g}".replace("-", "−") + (f" {unit}" if unit else "")


def _printed(unit: str) -> str:
    """``"kg*m^2"`` as it is read."""
    return "" if unit == "1" else unit.replace("^2", "²").replace("^3", "³").replace("*", " ")
