"""Two masses on a spring, of which a response is known exactly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.frf.machines import drive_recording
from tests.frf.sure import within
from workbench.frf import Channel, Frf, estimate
from workbench.frf.sampled import System, response, second_order


def two_mass_frf(noise: float, load: bool) -> tuple[np.ndarray, Frf]:
    """A response with white noise of a part of its size, and the covariance that says so."""
    theta = np.array([0.0048, 0.0053, 600.0, 0.02, 0.03, 0.02, 0.0004])
    spring = np.array([[1.0, -1.0], [-1.0, 1.0]])
    rows = np.eye(4)[:2] if load else np.eye(4)[:1]
    both = second_order(
        np.diag(theta[:2]), theta[3] * spring + np.diag(theta[4:6]), theta[2] * spring, theta[6], rows
    )
    base = within(estimate([drive_recording()], output="position"), 5, 99.9)
    g = response(System(both.a, both.b[:, :1], both.c, theta[6]), base.omega, 1e-3)
    generator = np.random.default_rng(0)
    size = noise * np.abs(g).mean(axis=(1, 2), keepdims=True)
    g = g + size / np.sqrt(2) * (generator.normal(size=g.shape) + 1j * generator.normal(size=g.shape))
    ny = len(rows)
    covariance = size**2 * np.eye(ny)
    names = [Channel("position", "m", "rad"), Channel("link_position", "m", "rad")][:ny]
    many = np.full(len(g), 1000.0)
    return theta, replace(
        base, response=g, covariance=covariance, noise_covariance=covariance, outputs=tuple(names),
        coherence=np.ones((len(g), ny)), dof=many, noise_dof=many, fresh=many,
    )  # fmt: skip
