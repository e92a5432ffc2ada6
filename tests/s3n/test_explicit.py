"""Torques injected from the preceding step ring, and diverge where the linkage is heavy."""

from __future__ import annotations

import numpy as np
import pytest

from tests.s3n.make import HOLD, chirp_torque, leg_with_linkage
from workbench.core import InputError, SimulationError
from workbench.effects import load_model
from workbench.s3n import explicit_spectral_radius, run_variant


def test_the_radius_of_the_reference_leg() -> None:
    radius = explicit_spectral_radius(load_model("leg"), np.radians([0.0, 90.0, 180.0]))
    np.testing.assert_allclose(radius, [0.895, 0.867, 0.831], atol=5e-4)
    fine = explicit_spectral_radius(load_model("leg_kin_only"), np.linspace(0, np.pi, 50))
    assert (np.diff(fine) < 0).all()


def test_it_rings_at_the_sample_rate_but_follows_the_implicit() -> None:
    torque, at_rest = chirp_torque(200), (HOLD, np.zeros(2))
    leg = load_model("leg_kin_only")
    injected, implicit = (
        run_variant(leg, name, torque, start=at_rest, step=0.0005) for name in ("explicit", "s3n_full_paper")
    )
    np.testing.assert_allclose(injected.position, implicit.position, atol=5e-3)
    assert not np.allclose(injected.position, implicit.position, atol=1e-6)


def test_it_is_refused_where_it_diverges() -> None:
    heavy = leg_with_linkage(M11=3.0, M12=3.0, M22=3.0)
    alpha = np.radians([0.0, 60.0, 120.0])
    assert (explicit_spectral_radius(heavy, alpha) > 1.0).all()
    with pytest.raises(SimulationError, match=r"spectral radius 1\.\d+ at a knee angle of 60\.0 deg"):
        run_variant(heavy, "explicit", chirp_torque(20), start=(HOLD, np.zeros(2)))
    # what the refusal points to runs
    assert np.isfinite(
        run_variant(heavy, "s3n_full", chirp_torque(20), start=(HOLD, np.zeros(2))).position
    ).all()


def test_it_is_refused_where_the_motion_gets_to() -> None:
    """A linkage that is stable with the knee folded and not with it stretched."""
    heavy = leg_with_linkage(M12=6.0)
    radius = explicit_spectral_radius(heavy, np.array([0.2, 2.0]))
    assert radius[1] < 1.0 <= radius[0]
    unfold = np.tile([0.0, -1.5], (400, 1))
    with pytest.raises(SimulationError, match="knee angle"):
        run_variant(heavy, "explicit", unfold, start=(np.array([0.0, 2.0]), np.zeros(2)))


def test_without_a_linkage_there_is_nothing_to_inject() -> None:
    with pytest.raises(InputError, match="parallelogram"):
        explicit_spectral_radius(load_model("emps"), np.zeros(1))
