"""Two inertias on a flexible coupling, measured: what a rigid model cannot have.

    python analyses/two_mass.py data/two_mass/MultisineTypeA.mat --output out/two_mass

A log of HoriFujimotoLab/FdiTools (MIT): 20 periods of a multisine, 11 to 250 Hz, on the motor current, on
every line (MultisineTypeA.mat) or on every fourth (MultisineTypeB.mat); the logged reference says on which.
Tops and dips are read off the response, a motor and a load on a spring are fitted to the motor's side alone,
and the load's side, which the fit never saw, judges it. Then the diagnosis is given both inertias as one
rigid shaft, and of the motor's side two stretches of five periods: one to fit, one to judge. All is per
ampere.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import tomli_w
from rich.table import Table
from two_mass_fit import fit_two_mass, two_mass_numbers

from workbench import improve, load_model, load_recordings, report
from workbench.core import Improvement, Recording
from workbench.core.files import write_whole
from workbench.frf import estimate, find_resonances
from workbench.models import Model

_SHAFT = """<mujoco model="shaft"><worldbody><body>
<joint name="motor" axis="0 0 1" armature="{motor:.9g}"/>
<inertial pos="0 0 0" mass="1" diaginertia="{load:.9g} {load:.9g} {load:.9g}"/>
</body></worldbody></mujoco>
"""
_PUBLISHED = {"antiresonance_hz": 53.0, "resonance_hz": 77.0, "inertia_ratio": 1.1}


def description(table: Path) -> str:
    """The recording's TOML for the MATLAB file."""
    multisine = {"kind": "multisine", "period_s": 1.0, "f_min_hz": 11.0, "f_max_hz": 250.0}
    return tomli_w.dumps(
        {
            "format": 1,
            "name": "two_mass",
            "table": str(table.resolve()),
            "axes": ["motor"],
            "columns": {
                "time": {"column": "time", "scale": 1e-6},
                "position": "theta_mx",
                "link_position": {"column": "theta_my", "scale": -1.0},
                "current": "iq_adx",
                "torque_measured": "iq_adx",
                "torque_command": "iq_refx",
            },
            "controller": {"kind": "none"},
            "timing": {"initial_at_rest": False},
            "excitation": multisine,
        }
    )


def half(recording: Recording, first: int) -> Recording:
    """Every other stretch of five periods, from the first or the second on."""
    rows = len(recording) // 4
    part = slice((1 + 2 * first) * rows, (2 + 2 * first) * rows)
    return replace(recording.rows(part), name=f"{recording.name}_{first}")


def rigid(motor: float, load: float, folder: Path) -> Model:
    """A rigid shaft of both inertias [kg m^2 per N m/A], written into a folder."""
    write_whole(folder / "shaft.xml", _SHAFT.format(motor=motor, load=load), force=True)
    return load_model(str(folder / "shaft.xml"))


def diagnosed(recording: Recording, motor: float, load: float, folder: Path) -> Improvement:
    """What a rigid shaft of both inertias is found to lack."""
    return improve(rigid(motor, load, folder), [half(recording, 0)], [half(recording, 1)])[0]


def main() -> None:
    """Estimate, fit, judge, print and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("table", type=Path, help="MultisineTypeA.mat or MultisineTypeB.mat")
    parser.add_argument("--output", type=Path, default=Path("out/two_mass"))
    arguments = parser.parse_args()
    write_whole(arguments.output / "two_mass.toml", description(arguments.table), force=True)
    recordings = load_recordings([arguments.output / "two_mass.toml"])
    frf = estimate(recordings, input="current", output=("position", "link_position"))
    motor = frf.select(["position_motor"], ["motor"])
    fitted = fit_two_mass(motor)
    read = {f"{r.kind}_hz": r.frequency for r in find_resonances(motor) if 40 < r.frequency.value < 100}
    table = Table("", "fitted", "read off the response", "published")
    for name, published in _PUBLISHED.items():
        own, seen = two_mass_numbers(fitted)[name], read.get(name)
        shown = "" if seen is None else f"{seen.value:.2f} ± {2 * seen.std:.2f}"
        table.add_row(name, f"{own.value:.3g} ± {2 * own.std:.2g}", shown, f"{published:g}")
    report.print_table(table)
    p = {k: v.value for k, v in fitted.parameters.items()}
    s = 1j * frf.omega
    coupling = p["stiffness"] + p["damping_coupling"] * s
    here = p["inertia_motor"] * s**2 + p["damping_motor"] * s + coupling
    there = p["inertia_load"] * s**2 + p["damping_load"] * s + coupling
    late = np.exp(-s * p["delay"])
    flexible = np.stack([there, coupling]) / (here * there - coupling**2) * late
    below = frf.frequency < 25.0
    whole = np.median(1.0 / np.abs(frf.response[below, 0, 0] * s[below] ** 2))
    rigid = np.stack([1.0 / (whole * s**2)] * 2)
    errors = Table("log-magnitude error [dB rms]", "motor (fitted)", "load (never seen)")
    measured = 20 * np.log10(np.abs(frf.response[:, :, 0].T))
    for name, model in (("rigid", rigid), ("two masses", flexible)):
        rest = np.sqrt(np.mean((20 * np.log10(np.abs(model)) - measured) ** 2, axis=1))
        errors.add_row(name, *(f"{e:.1f}" for e in rest))
    report.print_table(errors)
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained", sharey=True)
    for k, (ax, title) in enumerate(zip(axes, ("motor", "load"), strict=True)):
        ax.semilogx(frf.frequency, measured[k], ".", color="0.5", label="measured")
        ax.semilogx(frf.frequency, 20 * np.log10(np.abs(rigid[k])), color="C3", label="rigid")
        ax.semilogx(frf.frequency, 20 * np.log10(np.abs(flexible[k])), color="C0", label="two masses")
        ax.set(title=title, xlabel="frequency [Hz]", ylabel="angle over current [dB rad/A]")
    axes[0].legend()
    report.save_figure(figure, arguments.output / "response.png", force=True)
    found = diagnosed(recordings[0], p["inertia_motor"], p["inertia_load"], arguments.output)
    report.print_table(report.improvement_table(found))
    report.save_figure(report.ladder_figure(found), arguments.output / "error_falling.png", force=True)
    print(f"stiffness by the response alone: {p['stiffness']:.4g} N m/rad per ampere")


if __name__ == "__main__":
    main()
