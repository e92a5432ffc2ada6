"""Motion that nothing drives, integrated without the project's simulator: a pendulum."""

from __future__ import annotations

from collections.abc import Callable
from math import sin, tanh
from pathlib import Path

import numpy as np

from workbench.core import Controller, Recording, Timing
from workbench.effects import load_model
from workbench.models import Model

MASS, LENGTH, OWN = 1.2, 0.4, 0.02
INERTIA = OWN + MASS * LENGTH**2
STEP = 0.005

PENDULUM = f"""<mujoco model="pendulum"><worldbody><body name="arm">
  <joint name="swing" type="hinge" axis="0 1 0"/>
  <inertial pos="0 0 {-LENGTH}" mass="{MASS}" diaginertia="{OWN} {OWN} 0.001"/></body></worldbody>
  <actuator><motor name="swing" joint="swing"/></actuator></mujoco>"""

#: Torque on the pin by time [s], angle [rad] and rate [rad/s].
Torque = Callable[[float, float, float], float]


def friction(viscous: float = 0.0, coulomb: float = 0.0) -> Torque:
    """Viscous damping [N m s/rad] and Coulomb friction [N m]."""
    return lambda t, q, w: -viscous * w - coulomb * tanh(w / 0.005)


def nothing(t: float, q: float, w: float) -> float:
    """No torque."""
    return 0.0


def swing(angle: float, torque: Torque = nothing, more: float = 0.0, duration: float = 15.0) -> np.ndarray:
    """Angle (N,) of a pendulum let go at an angle, every `STEP`; `more` inertia than the model's [kg m^2]."""
    parts = 20
    h, q, w, out = STEP / parts, angle, 0.0, []

    def rate(t: float, q: float, w: float) -> float:
        return (-MASS * 9.81 * LENGTH * sin(q) + torque(t, q, w)) / (INERTIA + more)

    for k in range(round(duration / STEP)):
        out.append(q)
        for j in range(parts):  # plain numbers: for two of them arrays take ten times as long
            t = k * STEP + j * h
            a = rate(t, q, w)
            wb = w + h / 2 * a
            b = rate(t + h / 2, q + h / 2 * w, wb)
            wc = w + h / 2 * b
            c = rate(t + h / 2, q + h / 2 * wb, wc)
            wd = w + h * c
            d = rate(t + h, q + h * wc, wd)
            q, w = q + h / 6 * (w + 2 * wb + 2 * wc + wd), w + h / 6 * (a + 2 * b + 2 * c + d)
    return np.array(out)


def recorded(
    angle: np.ndarray, *, noise: float = 5e-4, torque_noise: float = 0.0, seed: int = 0
) -> Recording:
    """What sensors show of it."""
    rng = np.random.default_rng(seed)
    measured = (angle + noise * rng.standard_normal(len(angle)))[:, None]
    torque = torque_noise * rng.standard_normal(measured.shape)
    return Recording(
        name=f"swing_{seed}",
        axes=("swing",),
        coordinates="joint",
        time=STEP * np.arange(len(angle)),
        signals={
            "position": measured,
            "velocity": np.gradient(measured, STEP, axis=0),
            "torque_measured" if torque_noise else "torque_command": torque,
        },
        units=("rad",),
        controller=Controller(kind="none"),
        timing=Timing(initial_at_rest=False),
        derived=("velocity",),
    )


def pendulum(folder: Path) -> Model:
    """The model, with neither friction nor a rotor."""
    file = folder / "pendulum.xml"
    file.write_text(PENDULUM)
    return load_model(str(file))
