"""A measured frequency response: the numbers, their uncertainty, and where they come from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from workbench.core.shown import Shown

from .channel import Channel, place_of
from .pooling import pooled_covariance
from .statistics import real_halfwidth

if TYPE_CHECKING:
    from control import FrequencyResponseData

_BY_LINE = (
    "frequency",
    "response",
    "covariance",
    "noise_covariance",
    "dof",
    "noise_dof",
    "fresh",
    "leverage",
    "coherence",
)


@dataclass(frozen=True, eq=False, repr=False)
class Frf(Shown):
    """Frequency response of ny outputs to nu inputs at F frequencies, with its covariance.

    ``response[k, i, j]`` is output i over input j at ``frequency[k]``; python-control holds the same number
    as ``frdata[i, j, k]``. The vector of a response is its rows one after another (numpy's order): entry
    (i, j) stands at ``i * nu + j``. Covariances are E d d^H of the complex error d, circular: real and
    imaginary part each have half the variance.

    Attributes:
        frequency: [Hz], ascending, shape (F,).
        response: (F, ny, nu), complex.
        covariance: (F, ny nu, ny nu): all that scatters. With several realisations of a random excitation
            that is noise and stochastic nonlinear distortion; `notes` say where it is noise alone.
        noise_covariance: the same of the noise alone.
        dof: complex residuals behind `covariance`, shape (F,).
        noise_dof: behind `noise_covariance`, shape (F,).
        fresh: residuals behind `covariance` that a line does not share with its neighbour, shape (F,).
        estimated: what these residuals estimated: ``"outputs"``, an (ny, ny) matrix whose Kronecker product
            with a known one is the covariance, or ``"response"``, the whole matrix.
        leverage: what the inputs make of the outputs' noise, (F, nu, nu): the noise's covariance is the
            Kronecker product of the outputs' with it.
        coherence: multiple coherence of each output, from one period (or window) of data, (F, ny).
        outputs, inputs: what the rows and columns are.
        rate_hz: rows of the recordings per second.
        hold_s: the input stood still for this long from each row on (a sampled command) [s]; None where it
            is smooth between the rows (a measured torque).
        posture: mean measured position of each axis of the recordings [rad or m].
        coordinates: of the recordings.
        method: how it was estimated.
        periods: periods (or windows) that were averaged, all experiments together.
        realisations: sets of experiments.
        notes: what the reader should know, one sentence each.
    """

    frequency: np.ndarray
    response: np.ndarray
    covariance: np.ndarray
    noise_covariance: np.ndarray
    dof: np.ndarray
    noise_dof: np.ndarray
    estimated: Literal["outputs", "response"]
    fresh: np.ndarray
    leverage: np.ndarray
    coherence: np.ndarray
    outputs: tuple[Channel, ...]
    inputs: tuple[Channel, ...]
    rate_hz: float
    hold_s: float | None
    posture: tuple[float, ...]
    coordinates: Literal["actuator", "joint"]
    method: str
    periods: int
    realisations: int
    notes: tuple[str, ...] = ()

    _shown_by = "workbench.verification.notebook"

    def __post_init__(self) -> None:
        for name in _BY_LINE:
            view = np.asarray(getattr(self, name)).view()
            view.flags.writeable = False
            object.__setattr__(self, name, view)

    def __len__(self) -> int:
        return len(self.frequency)

    @property
    def omega(self) -> np.ndarray:
        """Return the angular frequency [rad/s], shape (F,)."""
        return 2 * np.pi * self.frequency

    @property
    def std(self) -> np.ndarray:
        """Return the standard deviation sqrt(E |error|^2) of every entry, (F, ny, nu)."""
        return np.sqrt(np.einsum("fii->fi", self.covariance).real).reshape(self.response.shape)

    @property
    def wishart_size(self) -> int:
        """Return the number of rows of the matrix that the residuals estimated."""
        return len(self.outputs) if self.estimated == "outputs" else len(self.outputs) * len(self.inputs)

    def magnitude_interval(self, level: float = 0.95) -> tuple[np.ndarray, np.ndarray]:
        """Return the lower and upper end for the magnitude at this probability, each (F, ny, nu)."""
        half = real_halfwidth(self.std**2, self.dof[:, None, None], level)
        size = np.abs(self.response)
        return np.maximum(size - half, 0.0), size + half

    def phase_interval(self, level: float = 0.95) -> tuple[np.ndarray, np.ndarray]:
        """Return the lower and upper end for the phase [rad], each (F, ny, nu); a full turn where nothing is
        known.
        """
        half = real_halfwidth(self.std**2, self.dof[:, None, None], level)
        size = np.abs(self.response)
        known = half < size
        turn = np.where(known, np.arcsin(np.where(known, half, 0.0) / np.where(known, size, 1.0)), np.pi)
        phase = np.angle(self.response)
        return phase - turn, phase + turn

    def select(self, outputs: Sequence[str | int], inputs: Sequence[str | int]) -> Frf:
        """Return some outputs and inputs, by number or by axis name.

        Raises:
            InputError: a name that is not there, or stands for several.
        """
        rows = [place_of(o, self.outputs) for o in outputs]
        columns = [place_of(i, self.inputs) for i in inputs]
        entries = np.add.outer(np.array(rows) * len(self.inputs), np.array(columns)).ravel()
        block = np.ix_(np.arange(len(self)), entries, entries)
        return replace(
            self,
            response=self.response[:, rows][:, :, columns],
            covariance=self.covariance[block],
            noise_covariance=self.noise_covariance[block],
            leverage=self.leverage[:, columns][:, :, columns],
            coherence=self.coherence[:, rows],
            outputs=tuple(self.outputs[r] for r in rows),
            inputs=tuple(self.inputs[c] for c in columns),
        )

    def kept(self, lines: np.ndarray) -> Frf:
        """Return some of the lines, by number or (F,) bool."""
        return replace(self, **{name: getattr(self, name)[lines] for name in _BY_LINE})

    def transformed(
        self,
        left: np.ndarray,
        right: np.ndarray,
        *,
        outputs: tuple[Channel, ...],
        inputs: tuple[Channel, ...],
    ) -> Frf:
        """Return the response in other coordinates: ``left @ response @ right``, both real.

        With q_p = J q_s and tau_s = J^T tau_p, a joint response becomes an actuator response by
        ``left = J`` and ``right = J.T``. Coherence is not defined for mixtures and becomes NaN.
        """
        across = np.kron(left, right.T)
        return replace(
            self,
            response=left @ self.response @ right,
            covariance=across @ self.covariance @ across.T,
            noise_covariance=across @ self.noise_covariance @ across.T,
            leverage=right.T @ self.leverage @ right,
            coherence=np.full((len(self), len(left)), np.nan),
            outputs=outputs,
            inputs=inputs,
        )

    def smoothed(self, lines: int) -> Frf:
        """Return the response with covariances averaged over `lines` lines to each side, residuals pooled.

        Few periods or realisations leave a scattered (or singular) covariance. What is averaged is the
        covariance of the outputs, whose spectrum varies slowly with frequency, and each line's own inputs
        make it that of the response again. The response stays as it is.
        """
        if lines < 1 or len(self) < 2:
            return self
        one = np.eye(len(self.outputs))
        factor = np.linalg.cholesky(self.leverage)
        there, back = (_across(one, f) for f in (factor, np.linalg.inv(factor)))

        def pooled(covariance: np.ndarray, dof: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            outputs = back @ covariance @ np.conj(np.swapaxes(back, 1, 2))
            fresh = np.minimum(self.fresh, dof)
            mean, total = pooled_covariance(outputs, dof, fresh, self.frequency, lines)
            return there @ mean @ np.conj(np.swapaxes(there, 1, 2)), total

        covariance, dof = pooled(self.covariance, self.dof)
        noise, noise_dof = pooled(self.noise_covariance, self.noise_dof)
        note = f"Covariances are averages over up to {min(2 * lines + 1, len(self))} neighbouring lines."
        return replace(
            self,
            covariance=covariance,
            noise_covariance=noise,
            dof=dof,
            noise_dof=noise_dof,
            notes=(*self.notes, note),
        )

    def to_control(self) -> FrequencyResponseData:
        """Return the response for python-control: ``frdata[output, input, frequency]``, frequencies in
        rad/s.
        """
        from control import FrequencyResponseData

        return FrequencyResponseData(
            np.moveaxis(self.response, 0, -1),
            self.omega,
            inputs=[str(c) for c in self.inputs],
            outputs=[str(c) for c in self.outputs],
        )


def _across(one: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """Return the Kronecker product of a matrix with each of (F, n, n)."""
    size = len(one) * factors.shape[1]
    return np.einsum("ik,fjl->fijkl", one, factors).reshape(len(factors), size, size)
