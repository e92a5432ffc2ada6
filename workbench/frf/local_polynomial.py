"""Frequency responses from records that do not repeat: chirps, noise, short runs.

At neighbouring lines of the whole record's spectrum the response and the leakage term (what the record's
beginning and end leave) are both smooth, the input is not. Fitted as polynomials over a window of lines,
they come apart, and what the fit leaves is the noise:

    Y(k + r) = [G + g_1 r + ... ] U(k + r) + [T + t_1 r + ...] + V(k + r)

J. Schoukens, G. Vandersteen, K. Barbe and R. Pintelon, "Nonparametric preprocessing in system identification:
a powerful tool", European J. Control 15, 2009; R. Pintelon, J. Schoukens, G. Vandersteen and K. Barbe,
"Estimation of nonparametric noise and FRF models for multivariable systems", Mech. Syst. Signal Process. 24,
2010; Pintelon and Schoukens 2012, ch. 7. In closed loop outputs and inputs are both fitted to the reference,
and the response is the quotient (the same sources, joint input-output approach).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.fft

from workbench.core import InputError, Recording
from workbench.core.text import counted

from .algebra import kronecker
from .records import Choice, check_rows, choose
from .response import Frf

_CHUNK = 2_000_000  # numbers in the regressors of the lines that are solved together
_SPARE = 8  # residuals behind the noise's covariance, beyond its size


def local_polynomial(
    recordings: Sequence[Recording],
    *,
    input: str | None = None,
    output: str | Sequence[str] | None = None,
    reference: str | None = "auto",
    axes: Sequence[str] | None = None,
    f_min_hz: float | None = None,
    f_max_hz: float | None = None,
    order: int = 2,
    halfwidth: int | None = None,
    step: int | None = None,
) -> Frf:
    """Return the frequency response about one posture, with the covariance of what the fits leave.

    Args:
        recordings: one or several of one posture, of any excitation that is rough along frequency; of
            different lengths the last rows of each are taken.
        input, output, reference, axes: as `estimate`. Where a reference is there, the response is the
            quotient of those from reference to output and to input, which feedback does not bias.
        f_min_hz, f_max_hz: band [Hz]; None takes what the recordings say of their excitation.
        order: of the polynomials, even orders are best.
        halfwidth: lines to each side; None takes as few as leave enough residuals.
        step: lines between estimates; None takes a whole window, so that estimates share no data and their
            errors are independent.

    Raises:
        InputError: recordings too short for the windows, gaps, inputs that cannot be told apart, or
            anything wrong with a recording.
    """
    choice = choose(recordings, input=input, output=output, reference=reference, axes=axes)
    first = recordings[0]
    outputs, inputs = choice.channels(first)
    ny, nu = len(outputs), len(inputs)
    rows = min(len(r) for r in recordings)
    for r in recordings:
        check_rows(r, choice, len(r) - rows, len(r))
    bins = _band(recordings, rows, f_min_hz, f_max_hz)
    fitted = ny + nu if choice.reference else ny
    half = halfwidth or _halfwidth(order, nu, len(recordings), fitted)
    window = 2 * half + 1
    left = len(recordings) * (window - order - 1) - nu * (order + 1)
    if order < 0 or left < fitted or window > len(bins):
        raise InputError(
            f"windows of {window} lines of {len(bins)} in the band are not enough for {counted(nu, 'input')} "
            f"of order {order}",
            file=first.source,
            column="halfwidth",
            remedy="record longer or more, widen the band, or name fewer axes",
        )
    spectra = np.stack([_spectrum(r, choice, rows, bins) for r in recordings])
    centres = np.arange(half, len(bins) - half, step or window)
    z, unit, noise = _solve(spectra, centres, half, order, fitted, nu, first, bins / (rows * first.period))
    if choice.reference:
        z, unit, noise = _quotient(z, unit, noise, ny)
    power = np.mean(np.abs(spectra[:, centres, :ny]) ** 2, axis=0)
    quiet = np.einsum("fii->fi", noise).real
    covariance = kronecker(noise, unit)
    dof = np.full(len(centres), float(left))
    return Frf(
        frequency=bins[centres] / (rows * first.period),
        response=z,
        covariance=covariance,
        noise_covariance=covariance,
        dof=dof,
        noise_dof=dof,
        estimated="outputs",
        fresh=dof * min(1.0, (step or window) / window),
        leverage=unit,
        coherence=np.clip(1 - quiet / np.maximum(power, 1e-300), 0.0, 1.0),
        outputs=outputs,
        inputs=inputs,
        rate_hz=1.0 / first.period,
        hold_s=choice.hold(recordings),
        posture=tuple(np.mean([r.position[-rows:].mean(axis=0) for r in recordings], axis=0).tolist()),
        coordinates=first.coordinates,
        method="local_polynomial",
        periods=len(recordings),
        realisations=1,
        notes=("The variance is the residual of local fits: noise, and distortion of a rough excitation.",),
    )


def _halfwidth(order: int, nu: int, records: int, fitted: int) -> int:
    """Return the fewest lines to each side that leave `_SPARE` more residuals than the covariance's rows."""
    terms = order + 1
    window = terms + int(np.ceil((nu * terms + fitted + _SPARE) / records))
    return window // 2


def _band(
    recordings: Sequence[Recording], rows: int, f_min_hz: float | None, f_max_hz: float | None
) -> np.ndarray:
    """Return the harmonics of the record inside the band, ascending."""
    first = recordings[0]
    rate = 1.0 / first.period
    low = [r.excitation.f_min_hz for r in recordings if r.excitation.f_min_hz is not None]
    high = [r.excitation.f_max_hz for r in recordings if r.excitation.f_max_hz is not None]
    bottom = f_min_hz if f_min_hz is not None else max(low, default=rate / rows)
    top = f_max_hz if f_max_hz is not None else min(high, default=0.45 * rate)
    if not (0 <= bottom < top):
        raise InputError(
            f"a band from {bottom:g} to {top:g} Hz", file=first.source, column="f_min_hz",
            remedy="give 0 <= f_min_hz < f_max_hz",
        )  # fmt: skip
    if 2 * top >= rate:
        raise InputError(
            f"the band reaches {top:g} Hz where half the rate is {rate / 2:g} Hz", file=first.source,
            column="f_max_hz", remedy="lower it or log faster",
        )  # fmt: skip
    return np.arange(max(1, int(np.ceil(bottom * rows / rate))), int(top * rows / rate) + 1)


def _spectrum(recording: Recording, choice: Choice, rows: int, bins: np.ndarray) -> np.ndarray:
    """Return the spectrum of a record's last rows, outputs, inputs, references: (bins, nz)."""
    columns = choice.columns(recording)[-rows:]
    # a constant only leaks; without it less has to be explained
    block = np.ascontiguousarray((columns - columns.mean(axis=0)).T)
    return np.asarray(scipy.fft.rfft(block, axis=1)).T[bins] / np.sqrt(rows)


def _solve(
    spectra: np.ndarray,
    centres: np.ndarray,
    half: int,
    order: int,
    fitted: int,
    nu: int,
    recording: Recording,
    frequency: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return local fits of the first `fitted` signals to the last `nu`: response, covariance of its error,
    residuals' covariance.

    Args:
        spectra: (E, bins, nz); the last nu columns drive.
        centres: windows' centres as places in bins, (F,).
        frequency: of the bins [Hz], for the error text.

    Returns:
        ``(z, unit, noise)``: responses (F, fitted, nu), K^T K* (F, nu, nu), covariance of the residuals
        (F, fitted, fitted).
    """
    records, _, nz = spectra.shape
    r = np.arange(-half, half + 1) / half
    basis, _ = np.linalg.qr(np.vander(r, order + 1, increasing=True), mode="complete")
    clear = basis[:, order + 1 :].T  # what no polynomial explains: the leakage term is gone
    powers = np.vander(r, order + 1, increasing=True)
    terms, kept = nu * (order + 1), len(clear)
    z = np.empty((len(centres), fitted, nu), complex)
    unit = np.empty((len(centres), nu, nu), complex)
    noise = np.empty((len(centres), fitted, fitted), complex)
    step = max(1, _CHUNK // (records * kept * (terms + fitted)))
    for k in range(0, len(centres), step):
        here = centres[k : k + step]
        window = spectra[:, here[:, None] + np.arange(-half, half + 1)]  # (E, F, W, nz)
        drive = window[..., nz - nu :]
        x = drive[..., None, :] * powers[:, :, None]
        x = clear @ x.reshape(records, len(here), 2 * half + 1, terms)
        y = clear @ window[..., :fitted]
        x, y = (np.moveaxis(a, 0, 1).reshape(len(here), records * kept, -1) for a in (x, y))
        # columns of one size, so that the order of the polynomial does not spoil the solution
        size = np.linalg.norm(x, axis=1)
        q, upper = np.linalg.qr(x / np.maximum(size, 1e-300)[:, None, :])
        diagonal = np.abs(np.einsum("fii->fi", upper))
        if (diagonal.min(axis=1) < 1e-9).any() or (size == 0).any():
            bad = here[int(np.argmax((diagonal.min(axis=1) < 1e-9) | (size == 0).any(axis=1)))]
            raise InputError(
                f"around {frequency[bad]:.4g} Hz the inputs cannot be told apart",
                file=recording.source,
                remedy="give a second record that drives the axes differently, or use `estimate` for a "
                "periodic excitation",
            )
        back = np.conj(np.swapaxes(q, 1, 2))
        inside = back @ y
        solution = np.linalg.solve(upper, inside) / size[:, :, None]
        rest = y - q @ inside
        z[k : k + step] = np.swapaxes(solution[:, :nu], 1, 2)
        inverse = np.linalg.inv(upper)[:, :nu] / size[:, :nu, None]
        unit[k : k + step] = inverse @ np.conj(np.swapaxes(inverse, 1, 2))
        left = rest.shape[1] - terms
        noise[k : k + step] = np.swapaxes(rest, 1, 2) @ np.conj(rest) / left
    return z, unit, noise


def _quotient(
    z: np.ndarray, unit: np.ndarray, noise: np.ndarray, ny: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the response of output to input from that of (output, input) to the reference; see `_solve`."""
    inverse = np.linalg.inv(z[:, ny:])
    g = z[:, :ny] @ inverse
    nu = g.shape[2]
    mix = np.concatenate([np.broadcast_to(np.eye(ny), (len(g), ny, ny)), -g], axis=2)
    own = mix @ noise @ np.conj(np.swapaxes(mix, 1, 2))
    turn = np.swapaxes(inverse, 1, 2)
    assert turn.shape[1:] == (nu, nu)
    return g, turn @ unit @ np.conj(np.swapaxes(turn, 1, 2)), own
