"""A model as a notebook shows it: drives and effects, and the links in the zero posture."""

from __future__ import annotations

import html

import mujoco
from matplotlib.figure import Figure

from workbench.core.palette import LINES
from workbench.core.picture import Picture

from .model import Model
from .skeleton import Skeleton


def as_html(model: Model) -> str:
    """Drives and effects in two tables; strangers' strings are escaped."""
    a = model.actuators
    drives = zip(model.axes, a.inertia, a.damping, a.torque_limit, strict=True)
    effects = [
        (str(e.key), ", ".join(f"{n} = {x.value:.4g} {x.unit}".strip() for n, x in e.parameters.items()))
        for e in model.effects
    ]
    head = ("drive", "inertia", "damping", "limit")
    first = _table(head, [(name, *(f"{x:.4g}" for x in numbers)) for name, *numbers in drives])
    second = _table(("effect", "parameters"), effects) if effects else "<p>No effects.</p>"
    told = f"{model.serial.name}, delay {1e3 * a.delay_s:.3g} ms, loop: {model.controller.kind}"
    title = f"<p><strong>{html.escape(model.name)}</strong> ({html.escape(told)})</p>"
    return f"<div>{title}{first}{second}</div>"


def as_figure(model: Model) -> Figure:
    """The links of the serial tree in its zero posture, to scale."""
    skeleton = Skeleton.of(model.serial)
    data = mujoco.MjData(skeleton.spec)
    mujoco.mj_kinematics(skeleton.spec, data)
    figure = Picture(figsize=(4.2, 4.2), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    style = LINES["closed_chain"]
    for body, ends in zip(skeleton.body, skeleton.ends, strict=True):
        points = ends @ data.xmat[body].reshape(3, 3).T + data.xpos[body]
        axes.plot(*points.T, "-o", color=style.light, lw=3, ms=5)
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")  # pyright: ignore[reportCallIssue]
    axes.set_title(model.name.replace("$", r"\$"), fontsize=10)
    axes.set_aspect("equal")
    return figure


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    top = "".join(f"<th>{html.escape(h)}</th>" for h in head)
    body = "".join(f"<tr>{''.join(f'<td>{html.escape(c)}</td>' for c in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"
