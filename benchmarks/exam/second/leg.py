"""The second leg as an instrument: what it hides goes in, recordings come out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import Controller, Recording, SimulationError

from . import equations as eq
from .bodies import Structure, structure
from .hidden import Hidden
from .march import run
from .motions import Motion

AXES = ("hip", "knee")
KP, KD = 50.0, 1.5  # N m/rad, N m s/rad
ROTOR, DAMPING, DELAY, LIMIT = 0.0162, 0.0972, 3e-3, 24.0  # of either drive, SI


@dataclass(frozen=True)
class Noise:
    """Of the sensors: encoder's step and white noise of angle [rad], of speed [rad/s], of torque [N m]."""

    encoder: float = 2 * np.pi / 2**15
    angle: float = 4e-5
    speed: float = 0.012
    torque: float = 0.024


SILENT = Noise(0.0, 0.0, 0.0, 0.0)


class SecondLeg:
    """The reference leg with all that is hidden in it.

    Args:
        hidden: effects of the catalogue, or outsiders, by name.
        seed: of noise and of random torques.
        noise: of the sensors.
        tick: period of the loop, a whole number of rows [s].

    Raises:
        KeyError: something that this leg cannot hide.
    """

    def __init__(
        self, hidden: Sequence[Hidden] = (), seed: int = 0, noise: Noise | None = None, tick: float = 3e-3
    ) -> None:
        self._seed, self._noise, self._tick = seed, noise or Noise(), tick
        self._links = structure()
        self._drives = np.zeros((12, 2))
        self._drives[[eq.ROTOR, eq.DAMPING, eq.LIMIT, eq.GAIN]] = [[ROTOR], [DAMPING], [LIMIT], [1.0]]
        self._sensors = np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
        self._gains = np.array([KP, KP, KD, KD])
        self._delay, self._late = DELAY, 0.0
        self._dry: list[list[float]] = []
        self._smooth: list[list[float]] = []
        self._dahl: list[list[float]] = []
        self._outside: list[Hidden] = []
        for each in hidden:
            self._hide(each)

    def run(self, motions: Sequence[Motion]) -> list[Recording]:
        """The motions as they are logged, in actuator coordinates, references in those of the joints.

        Raises:
            SimulationError: the leg ran away.
        """
        return [self._record(motion, number) for number, motion in enumerate(motions)]

    def _record(self, motion: Motion, number: int) -> Recording:
        rows, period = len(motion.reference), motion.period
        generator = np.random.default_rng([self._seed, number, 211])
        n = self._noise
        noise = generator.standard_normal((rows, 4)) * [n.angle, n.angle, n.speed, n.speed]
        at_sensor = n.torque * generator.standard_normal((rows, 2))
        time = np.arange(rows) * period
        shown = run(
            period, round(self._tick / period), self._delay, self._late, motion.reference, motion.feedforward,
            noise, n.encoder, self._unmeasured(time, generator), self._gains, self._sensors,
            _table(self._dry), _table(self._smooth), _table(self._dahl), np.array(self._links), self._drives,
        )  # fmt: skip
        if not np.isfinite(shown).all():
            raise SimulationError(f"the second leg ran away in '{motion.name}'")
        return Recording(
            name=motion.name,
            axes=AXES,
            coordinates="actuator",
            time=time,
            signals={
                "position": shown[:, :2],
                "velocity": shown[:, 2:4],
                "torque_command": shown[:, 4:6],
                "torque_measured": shown[:, 6:] + at_sensor,
                "torque_feedforward": motion.feedforward,
                "position_reference": motion.reference,
            },
            units=("rad", "rad"),
            controller=Controller("pd", "joint", kp=(KP, KP), kd=(KD, KD), period_s=self._tick),
            excitation=motion.excitation,
            rig="leg",
        )

    def _unmeasured(self, time: np.ndarray, generator: np.random.Generator) -> np.ndarray:
        """Torques of time alone (N, 2), held over each row [N m]."""
        total = np.zeros((len(time), 2))
        for each in self._outside:
            p, i = each.parameters, AXES.index(each.axis or "hip")
            middle = time + 0.5 * time[1]
            if each.effect == "hum":
                beat = 1.0 + 0.5 * np.sin(2 * np.pi * p["beat"] * middle)
                total[:, i] += p["torque"] * beat * np.sin(2 * np.pi * p["frequency"] * middle + p["phase"])
            else:  # a walk that is pulled back to zero
                kept = float(np.exp(-time[1] / p["time_constant"]))
                value = generator.standard_normal()
                for row, kick in enumerate(generator.standard_normal(len(time))):
                    total[row, i] += p["torque"] * value
                    value = kept * value + np.sqrt(1.0 - kept**2) * kick
        return total

    def _hide(self, each: Hidden) -> None:
        p, i = dict(each.parameters), AXES.index(each.axis or "hip")
        place = eq.PIN if each.location == "joint" and i else i
        match each.effect:
            case name if name in _SMOOTH:
                kind, keys = _SMOOTH[name]
                self._smooth.append(_row(kind, place, [p[key] for key in keys]))
            case name if name in _DRY:
                kind, keys = _DRY[name]
                self._dry.append(_row(kind, place, [p[key] for key in keys]))
            case name if name in _DRIVE:
                for key, row in _DRIVE[name].items():
                    self._drives[row, i] = p[key]
            case "presliding_hysteresis":
                self._dahl.append([place, p["torque"], p["stiffness"]])
            case "reflected_inertia":
                self._drives[eq.ROTOR, i] += p["inertia"]
            case "torque_bias":
                self._drives[eq.BIAS, i] += p["torque"]
            case "payload_mass":
                self._add(Structure(*np.subtract(structure(p["mass"]), structure())))
            case "linkage_inertia":
                self._add(Structure(p["M11"], p["M12"], p["M22"], 0.0, 0.0))
            case "linkage_gravity":
                self._add(Structure(0.0, 0.0, 0.0, p["g1"], p["g2"]))
            case "command_delay":
                self._delay += p["time"]
            case "sensor_delay":
                self._late += p["time"]
            case "controller_gain_error":
                self._gains[i] *= p["kp_scale"]
                self._gains[2 + i] *= p["kd_scale"]
            case "encoder_offset":
                self._sensors[1, i] += p["angle"]
            case "encoder_scale":
                self._sensors[0, i] *= p["scale"]
            case "encoder_eccentricity":
                self._sensors[2:, i] = p["amplitude"], p["phase"]
            case "hum" | "random_walk_torque":
                self._outside.append(each)
            case _:
                raise KeyError(each.effect)

    def _add(self, more: Structure) -> None:
        self._links = Structure(*np.add(self._links, more))


_SMOOTH = {
    "viscous_damping": (eq.VISCOUS, ("damping",)),
    "quadratic_drag": (eq.QUADRATIC, ("drag",)),
    "parallel_spring": (eq.SPRING, ("stiffness", "rest")),
    "cogging": (eq.RIPPLE, ("torque", "order", "phase")),
    "cubic_spring": (eq.CUBIC, ("stiffness", "rest")),
    "one_sided_spring": (eq.STRAP, ("stiffness", "rest")),
    "detent": (eq.DETENT, ("torque", "angle", "width")),
    "cross_damping": (eq.CROSS, ("damping",)),
}
_DRY = {
    "coulomb_friction": (eq.COULOMB, ("torque",)),
    "stribeck_friction": (eq.STRIBECK, ("coulomb", "static", "speed")),
    "asymmetric_friction": (
        eq.UNEVEN,
        ("damping_positive", "damping_negative", "torque_positive", "torque_negative"),
    ),
    "load_dependent_friction": (eq.LOADED, ("torque", "ratio")),
    "position_dependent_friction": (eq.PATCHY, ("torque", "order", "phase")),
}
_DRIVE = {
    "torque_constant_error": {"gain": eq.GAIN},
    "torque_saturation": {"limit": eq.LIMIT},
    "speed_torque_limit": {"stall_torque": eq.STALL, "no_load_speed": eq.NO_LOAD},
    "current_loop_lag": {"time_constant": eq.LAG},
    "velocity_filter_lag": {"time_constant": eq.FILTER},
    "joint_compliance": {"stiffness": eq.STIFFNESS, "damping": eq.SERIES},
    "backlash": {"gap": eq.GAP, "stiffness": eq.STIFFNESS, "damping": eq.SERIES},
}


def _row(kind: int, place: int, values: Sequence[float]) -> list[float]:
    return [float(kind), float(place), *values, *[0.0] * (4 - len(values))]


def _table(rows: list[list[float]]) -> np.ndarray:
    """(n, k) floats, also of no rows."""
    return np.array(rows, float) if rows else np.zeros((0, 6))
