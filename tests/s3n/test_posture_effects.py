"""Mass that effects add to links is in everything that is made of the closed chain."""

from __future__ import annotations

import numpy as np
import pytest

from tests.simulation.make import having
from workbench.core import EffectKey
from workbench.mechanism import ClosedChain
from workbench.models import read_model
from workbench.s3n import PostureDependent, fit_native

MODEL = read_model("four_bar")
LOADED = having(MODEL, EffectKey("payload_mass", None), mass=0.4)


def test_series_are_those_of_the_chain_that_carries_the_payload() -> None:
    assert MODEL.closed_chain is not None
    chain, truth = PostureDependent(LOADED), ClosedChain(MODEL.closed_chain, 0.4)
    q, v = np.array([[0.3, 1.1], [-0.7, 2.0]]), np.array([[1.0, -2.0], [3.0, 0.5]])
    found = chain.at(q)
    for k, state in enumerate(zip(q, v, strict=True)):
        true = truth.serial_dynamics(*state)
        np.testing.assert_allclose(found.links[k], true.mass, atol=1e-8)
        np.testing.assert_allclose(found.gravity[k], true.gravity, atol=1e-8)
        np.testing.assert_allclose(found.link_bias(v)[k], true.bias, atol=1e-8)


def test_what_is_written_for_others_has_it() -> None:
    made, bare = fit_native(LOADED), fit_native(MODEL)
    assert made.left_out == ()
    assert made.error.inertia_max < 0.01
    assert made.mujoco.body_mass.sum() == pytest.approx(
        bare.mujoco.body_mass.sum() + 0.4, abs=0.02
    )  # what no motion shows stays near the file's
