"""Hidden effects between the true motion and its log, and in the loop that reads the log."""

from __future__ import annotations

from .machine import Machine, Place, once


def sensor_delay(machine: Machine, at: Place, *, time: float) -> None:
    """Position and velocity of both motors are late, for the log and for the controller."""
    machine.sensor_delay += time


def velocity_filter_lag(machine: Machine, at: Place, *, time_constant: float) -> None:
    """The logged velocity, which the controller uses, is first-order filtered."""
    once(machine.velocity_lag[at.index], "velocity filter per motor")
    machine.velocity_lag[at.index] = time_constant


def encoder_offset(machine: Machine, at: Place, *, angle: float) -> None:
    """Measured = true + angle."""
    machine.encoders[at.index].offset += angle


def encoder_scale(machine: Machine, at: Place, *, scale: float) -> None:
    """Measured = scale true, velocity likewise."""
    machine.encoders[at.index].scale *= scale


def encoder_eccentricity(machine: Machine, at: Place, *, amplitude: float, phase: float) -> None:
    """Measured = true + amplitude sin(true + phase), and the velocity that belongs to it."""
    machine.encoders[at.index].eccentricity.append((amplitude, phase))


def controller_gain_error(machine: Machine, at: Place, *, kp_scale: float, kd_scale: float) -> None:
    """The loop's gains on one joint are these times those that its recording states."""
    machine.kp_scale[at.index] *= kp_scale
    machine.kd_scale[at.index] *= kd_scale
