"""A measured frequency response beside the closed chain's and every serial variant's, at one posture."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from workbench.core import InputError, Recording, SimulationError
from workbench.core.shown import Shown
from workbench.effects.structure import is_parallelogram
from workbench.frf import Frf, estimate_postures
from workbench.frf.sampled import response, second_order
from workbench.mechanism import ClosedChain, linearise
from workbench.models import VARIANTS, Model
from workbench.s3n import variant_dynamics

_EPS = 1e-4  # rad or m: central differences of gravity err by its square


@dataclass(frozen=True, eq=False, repr=False)
class FrfComparison(Shown):
    """A measured response beside those of models, at one posture.

    Attributes:
        frf: measured, actuator coordinates.
        models: name -> response (F, ny, nu) at the same lines: ``closed_chain`` and variants.
        error: name -> relative distance at every line, (F,): Frobenius norm of model minus measured over
            that of the measured.
        noise: what the measurement's own uncertainty would make of it, (F,).
    """

    frf: Frf
    models: dict[str, np.ndarray]
    error: dict[str, np.ndarray]
    noise: np.ndarray

    _shown_by = "workbench.verification.notebook"

    def overall(self, name: str) -> float:
        """Root mean square of the relative error over all lines."""
        return float(np.sqrt(np.mean(self.error[name] ** 2)))

    @property
    def overall_noise(self) -> float:
        """Return the same of the measurement's own uncertainty."""
        return float(np.sqrt(np.mean(self.noise**2)))

    def worst(self, name: str) -> float:
        """Frequency where the error stands out most above the noise [Hz]."""
        return float(self.frf.frequency[int(np.argmax(self.error[name] - self.noise))])


def compare_frf(model: Model, recordings: list[Recording]) -> list[FrfComparison]:
    """Measured responses beside the model's, one entry per posture.

    Args:
        model: with its drives' delay; variants and closed chain as far as it states them.
        recordings: periodically excited, about one posture or several.

    Raises:
        InputError: the recordings give no response, or have other axes than the model.
    """
    for recording in recordings:
        if tuple(recording.axes) != model.axes:
            raise InputError(
                f"axes are {', '.join(recording.axes)}, and those of model '{model.name}' "
                f"{', '.join(model.axes)}", file=recording.source, column="axes",
                remedy="name the model that the recording is of",
            )  # fmt: skip
    return [_compare(model, _in_drives(frf, model)) for frf in estimate_postures(recordings)]


def _compare(model: Model, frf: Frf) -> FrfComparison:
    models = model_responses(model, frf)
    size = np.linalg.norm(frf.response, axis=(1, 2))
    error = {name: np.linalg.norm(g - frf.response, axis=(1, 2)) / size for name, g in models.items()}
    return FrfComparison(frf, models, error, uncertainty_of(frf))


def uncertainty_of(frf: Frf) -> np.ndarray:
    """Return a measured response's own relative uncertainty at every line, all entries together, (F,)."""
    return np.sqrt(np.einsum("fii->f", frf.covariance).real) / np.linalg.norm(frf.response, axis=(1, 2))


def model_responses(model: Model, frf: Frf) -> dict[str, np.ndarray]:
    """Responses of the closed chain and of the serial variants, sampled and held as the measured one.

    Args:
        model: the model.
        frf: says where, at which lines, from which torque to which motion; actuator coordinates.

    Raises:
        InputError: the response is not from a torque to one of position and velocity.
    """
    signals = {c.signal for c in frf.outputs}
    if signals not in ({"velocity"}, {"position"}):
        raise InputError(
            f"the response is of {', '.join(sorted(signals))}", remedy="take velocity or position"
        )
    n = model.size
    zero, one = np.zeros((n, n)), np.eye(n)
    rows = np.concatenate([zero, one] if signals == {"velocity"} else [one, zero], axis=1)
    # a torque that was measured lies behind the delay
    delay = 0.0 if frf.inputs[0].signal == "torque_measured" else model.actuators.delay_s
    out = {}
    for name, (mass, damping, stiffness) in _small_motion(model, np.array(frf.posture)).items():
        out[name] = response(second_order(mass, damping, stiffness, delay, rows), frf.omega, frf.hold_s)
    return out


def _small_motion(model: Model, posture: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Mass, damping and stiffness in actuator coordinates about drive positions (n,), by model."""
    out = {}
    if model.closed_chain is not None:
        try:
            chain = ClosedChain(model.closed_chain)
            plant = linearise(chain, posture, model.actuators.inertia, model.actuators.damping)
            out["closed_chain"] = plant.mass, plant.damping, plant.stiffness
        except SimulationError as error:
            raise InputError(
                f"the posture of the recordings cannot be reached: {error}", file=model.source,
                remedy="check the recordings' zeros and the closed chain",
            ) from error  # fmt: skip
    n, back = model.size, np.linalg.inv(model.transmission)
    joints = back @ posture
    steps = joints + np.concatenate([np.zeros((1, n)), _EPS * np.eye(n), -_EPS * np.eye(n)])
    for name in _variants(model):
        at = variant_dynamics(model, name, steps, np.zeros_like(steps))
        slope = -(at.gravity[1 : n + 1] - at.gravity[n + 1 :]).T / (2.0 * _EPS)
        mass, damping, stiffness = (back.T @ x @ back for x in (at.mass[0], at.damping, slope))
        out[name] = mass, damping, (stiffness + stiffness.T) / 2.0
    return out


def _variants(model: Model) -> tuple[str, ...]:
    """Variants that this model has what it takes for; one is enough where a drive turns one joint."""
    if is_parallelogram(model):
        return tuple(VARIANTS)
    return (
        ("kin_only",) if np.array_equal(model.transmission, np.eye(model.size)) else ("kin_only", "s3n_act")
    )


def _in_drives(frf: Frf, model: Model) -> Frf:
    """The response in actuator coordinates."""
    if frf.coordinates == "actuator":
        return frf
    j = model.transmission
    turned = frf.transformed(j, j.T, outputs=frf.outputs, inputs=frf.inputs)

    return replace(turned, posture=tuple(j @ np.array(frf.posture)), coordinates="actuator")
