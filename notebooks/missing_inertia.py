"""The inertia and damping that a serial tree leaves out of a parallel leg, as numbers, tables and a picture.

By term and posture (paper, Eqs. 5, 12, 13, 19).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from rich.table import Table
from scipy.linalg import eigh

from workbench.core.palette import COLOURS, LINES
from workbench.core.picture import Picture
from workbench.models import Model
from workbench.report.layout import table as new_table
from workbench.report.response import words_of
from workbench.s3n.closed_forms import actuator_increment
from workbench.s3n.dynamics import variant_dynamics

_ENTRIES = (("M11", 0, 0), ("M12", 0, 1), ("M22", 1, 1))
_LINES = {name: LINES[name] for name in ("kin_only", "s3n_act", "s3n_full")}


@dataclass(frozen=True)
class InertiaGap:
    """The inertia that Kin-Only lacks over N knee angles, serial coordinates.

    Attributes:
        alpha: knee angles (N,) [rad].
        mass: variant -> mass matrix (N, 2, 2) [kg m^2].
        actuator: Delta M_act (2, 2), the same at every posture [kg m^2].
        linkage: Delta M_link (N, 2, 2) [kg m^2].
        damping: Delta D_act (2, 2) [N m s/rad].
        too_fast: by how much Kin-Only's acceleration exceeds the true one in the worst direction of torque,
            (N,): the largest eigenvalue of M_kin^-1 M_full, less one.
        worst: that direction of acceleration (N, 2), unit vectors of joint coordinates.
    """

    alpha: np.ndarray
    mass: dict[str, np.ndarray]
    actuator: np.ndarray
    linkage: np.ndarray
    damping: np.ndarray
    too_fast: np.ndarray
    worst: np.ndarray

    @property
    def actuator_share(self) -> np.ndarray:
        """Share of the gap that is the actuators', by Frobenius norm, (N,)."""
        actuator = np.linalg.norm(self.actuator)
        return actuator / (actuator + np.linalg.norm(self.linkage, axis=(1, 2)))


def inertia_gap(model: Model, alpha: np.ndarray) -> InertiaGap:
    """Return the gap of a parallelogram leg.

    Args:
        model: with its drives and linkage.
        alpha: knee angles (N,) [rad].

    Raises:
        InputError: the model has no parallelogram.
    """
    alpha = np.asarray(alpha, float)
    q = np.stack([np.zeros_like(alpha), alpha], axis=1)
    names = ("kin_only", "s3n_act", "s3n_full")
    mass = {name: variant_dynamics(model, name, q, np.zeros_like(q)).mass for name in names}
    too_fast, worst = np.empty(len(alpha)), np.empty((len(alpha), 2))
    for k, (kin, full) in enumerate(zip(mass["kin_only"], mass["s3n_full"], strict=True)):
        values, vectors = eigh(full, kin)
        too_fast[k] = values[-1] - 1.0
        worst[k] = vectors[:, -1] / np.linalg.norm(vectors[:, -1])
    return InertiaGap(
        alpha,
        mass,
        actuator_increment(np.array(model.actuators.inertia), model.transmission),
        mass["s3n_full"] - mass["s3n_act"],
        actuator_increment(np.array(model.actuators.damping), model.transmission),
        too_fast,
        worst,
    )


def papers_table(model: Model) -> Table:
    """Total equivalent inertia in serial coordinates at alpha = 90 degrees, and the change from Kin-Only."""
    mass = {name: m[0] for name, m in inertia_gap(model, np.array([np.pi / 2])).mass.items()}
    table = new_table("variant", *((name, "right") for name, _, _ in _ENTRIES))
    table.title = "Inertia at alpha = 90° in kg m² (change from Kin-Only)"
    for name, m in mass.items():
        cells = []
        for _, i, j in _ENTRIES:
            change = 100.0 * (m[i, j] / mass["kin_only"][i, j] - 1.0)
            cells.append(f"{m[i, j]:.5f}" + ("" if name == "kin_only" else f" ({change:+.1f} %)"))
        table.add_row(words_of(name), *cells)
    return table


def terms_table(gap: InertiaGap) -> Table:
    """What is missing over alpha, whose it is, and what that does to the acceleration."""
    columns = ("actuators", "linkage", "actuators' share", "Kin-Only too fast by")
    table = new_table("alpha", *((name, "right") for name in columns))
    table.title = "What is missing from Kin-Only (Frobenius norms in kg m²)"
    actuator = float(np.linalg.norm(gap.actuator))
    for k in range(0, len(gap.alpha), 30):
        linkage = float(np.linalg.norm(gap.linkage[k]))
        table.add_row(
            f"{np.degrees(gap.alpha[k]):.0f}°",
            f"{actuator:.5f}",
            f"{linkage:.5f}",
            f"{100 * gap.actuator_share[k]:.0f} %",
            f"{100 * gap.too_fast[k]:.0f} %",
        )
    b = gap.damping
    table.caption = (
        f"Damping that is missing at every posture: {b[0, 0]:.4f}, {b[0, 1]:.4f}, {b[1, 1]:.4f} N m s/rad."
    )
    return table


def gap_figure(gap: InertiaGap) -> Figure:
    """Entries of the mass matrix over alpha by variant, and how much too fast Kin-Only answers."""
    figure = Picture(figsize=(9.0, 2.9), layout="constrained")
    axes = figure.subplots(1, 4)
    degrees = np.degrees(gap.alpha)
    for ax, (name, i, j) in zip(axes, _ENTRIES, strict=False):
        for variant, line in _LINES.items():
            ax.plot(degrees, gap.mass[variant][:, i, j], label=words_of(variant), **line.drawn())
        ax.set_title(f"{name}, serial [kg m²]", fontsize=9, loc="left")
        low, high = ax.get_ylim()
        ax.set_ylim(min(0.0, low), high)
    axes[0].legend(frameon=False, fontsize=8)
    axes[3].plot(degrees, 100.0 * gap.too_fast, color=COLOURS["ink"][0])
    axes[3].set_title("acceleration too high by [%]", fontsize=9, loc="left")
    axes[3].set_ylim(0.0, 120.0 * gap.too_fast.max())
    for ax in axes:
        ax.set_xlabel("knee angle alpha [deg]")
        ax.set_xticks([0, 60, 120, 180])
        ax.grid(alpha=0.25)
        ax.spines[["top", "right"]].set_visible(False)
    return figure
