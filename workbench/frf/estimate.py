"""Frequency responses from periodic excitation, one axis or many, in open or closed loop.

The spectra of the experiments stand side by side, outputs Y (ny, E), inputs U (nu, E), and

    G = Y R^H (U R^H)^-1

where R are the spectra of the noise-free reference that drove the experiments. With as many experiments as
inputs this is Y U^-1 whatever R is. With more, it is the joint input-output estimate G_yr G_ur^-1: noise that
feedback carries from the output into the input is not correlated with the reference, and does not bias it, as
it would bias Y U^H (U U^H)^-1, which stands in where there is no reference.

Sources: R. Pintelon and J. Schoukens, "System Identification: A Frequency Domain Approach", 2nd ed. 2012,
ch. 2 (periodic signals, feedback, several inputs) and ch. 4 (robust and fast method).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from workbench.core import InputError, Recording
from workbench.core.text import counted

from .algebra import kronecker, output_noise, solve_inputs
from .excited import realisations
from .measure import Measured, measure
from .response import Frf
from .unexcited_lines import distortion_covariance


def estimate(
    recordings: Sequence[Recording],
    *,
    input: str | None = None,
    output: str | Sequence[str] | None = None,
    reference: str | None = "auto",
    axes: Sequence[str] | None = None,
    period_s: float | None = None,
    lines: Sequence[int] | None = None,
    transient_periods: int | None = None,
    leakage: bool = True,
    method: Literal["auto", "robust", "fast"] = "auto",
) -> Frf:
    """Return the frequency response about one posture, with its covariance.

    Args:
        recordings: experiments with one periodic excitation, at least as many as there are axes.
        input: signal the response is taken from; None: the torque command (the total torque that feedback
            and excitation ask for, before the delay), else the measured torque.
        output: one signal or several; None: the measured velocity, else the position.
        reference: noise-free signal that drove the loop; ``"auto"`` finds it, None does without.
        axes: some of the axes (the others must stand still); None takes all.
        period_s: None takes what the recordings state, else what their autocorrelation shows.
        lines: excited harmonics; None takes what the reference shows.
        transient_periods: leading periods to drop; None drops those that still differ from the later ones.
        leakage: subtract the leakage of the record's ends from the lines, and estimate the noise between
            them; else the periods are averaged, and their scatter is the noise.
        method: ``"robust"`` takes the total variance from realisation to realisation, ``"fast"`` adds to the
            noise what appears on silent odd lines; ``"auto"`` is robust with two realisations or more.

    Raises:
        InputError: too few experiments, periods or realisations, gaps, inputs that cannot be told apart, or
            anything wrong with a recording; the text names file, row and remedy.
    """
    measured = measure(
        recordings,
        input=input,
        output=output,
        reference=reference,
        axes=axes,
        period_s=period_s,
        lines=lines,
        transient_periods=transient_periods,
        leakage=leakage,
    )
    return frf_of(measured, method)


def frf_of(measured: Measured, method: Literal["auto", "robust", "fast"] = "auto") -> Frf:
    """Return the response from spectra; see `estimate`."""
    m, choice, first = measured, measured.choice, measured.recordings[0]
    outputs, inputs = choice.channels(first)
    ny, nu, count = len(outputs), len(inputs), len(m.recordings)
    if count < nu:
        raise InputError(
            f"{counted(count, 'experiment')} for {nu} inputs", file=first.source,
            remedy="record one experiment per axis (sum and difference for two), or name fewer axes",
        )  # fmt: skip
    here = m.at(m.lines)
    weight = np.sqrt([s.periods for s in m.spectra])
    z = np.stack([w * s.mean[here] for w, s in zip(weight, m.spectra, strict=True)], axis=2)  # (F, nz, E)
    y, u, r = z[:, :ny], z[:, ny : ny + nu], z[:, ny + nu :]
    driver = r if choice.reference is not None and count > nu else u
    k = solve_inputs(u, driver, m.frequency[here], first)
    g = y @ k
    unit = np.einsum("fea,feb->fab", k, k.conj())

    free = sum(s.free for s in m.spectra)
    noise_v = np.sum([s.free * output_noise(g, s.covariance[here], ny) for s in m.spectra], axis=0) / free
    noise = kronecker(noise_v, unit)
    sets = realisations(np.moveaxis(u if choice.reference is None else r, 2, 0), nu)
    wanted = "robust" if method == "auto" and len(sets) > 1 else method
    dof = np.full(len(g), float(free))
    # lines that stand close read the same noise between them
    apart = np.diff(m.lines, prepend=m.lines[0] - np.diff(m.lines, append=m.lines[-1] + 1)[:1])
    fresh = np.minimum(dof, apart * float(sum(s.periods - 1 for s in m.spectra)))
    covariance, kind, notes = noise, "outputs", list(m.notes)
    if wanted == "robust":
        if len(sets) < 2:
            raise InputError(
                "the robust method needs two realisations of the excitation or more", file=first.source,
                remedy="record sets with new random phases, or take method 'fast'",
            )  # fmt: skip
        covariance, kind = _between(y, u, sets), "response"
        dof = fresh = np.full(len(g), float(len(sets) - 1))
    elif len(m.listening[0]):
        extra, dof = distortion_covariance(m, g, noise_v, unit, free)
        covariance = noise + extra
        notes.append("The variance of nonlinear distortion is that of the unexcited odd lines nearby.")
        wanted = "fast"
    else:
        notes.append("The variance is that of noise alone: one realisation does not show distortion.")
        wanted = "noise"
    if choice.faster_than_log(m.recordings):
        notes.append("The controller is faster than the log: what the command did between rows is unknown.")
    return Frf(
        frequency=m.frequency[here],
        response=g,
        covariance=covariance,
        noise_covariance=noise,
        dof=dof,
        noise_dof=np.full(len(g), float(free)),
        estimated=kind,
        fresh=np.minimum(fresh, dof),
        leverage=unit,
        coherence=_coherence(m, g, ny),
        outputs=outputs,
        inputs=inputs,
        rate_hz=1.0 / first.period,
        hold_s=choice.hold(m.recordings),
        posture=tuple(float(x) for x in m.posture),
        coordinates=first.coordinates,
        method=wanted,
        periods=sum(s.periods for s in m.spectra),
        realisations=len(sets),
        notes=tuple(notes),
    )


def _between(y: np.ndarray, u: np.ndarray, sets: list[list[int]]) -> np.ndarray:
    """Return the covariance of the mean response from its scatter between realisations; (F, ny nu, ny nu)."""
    each = np.stack([y[:, :, s] @ np.linalg.pinv(u[:, :, s]) for s in sets])
    d = (each - each.mean(axis=0)).reshape(len(sets), len(y), -1)
    return np.einsum("mfa,mfb->fab", d, d.conj()) / (len(sets) * (len(sets) - 1))


def _coherence(m: Measured, g: np.ndarray, ny: int) -> np.ndarray:
    """Return the share of each output's power in one period that is the response to the inputs; (F, ny)."""
    here = m.at(m.lines)
    total = left = np.zeros((len(here), ny))
    for s in m.spectra:
        mean, noise = s.mean[here], s.covariance[here]
        v = mean[:, :ny] - np.einsum("fij,fj->fi", g, mean[:, ny : ny + g.shape[2]])
        own = np.einsum("fii->fi", output_noise(g, noise, ny)).real
        left = left + s.periods * (own + np.abs(v) ** 2)
        power = np.einsum("fii->fi", noise[:, :ny, :ny]).real
        total = total + s.periods * (power + np.abs(mean[:, :ny]) ** 2)
    return np.clip(1 - left / np.maximum(total, 1e-300), 0.0, 1.0)
