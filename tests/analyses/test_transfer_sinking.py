"""A foot that sinks under a known force tells stiffness and damping, whatever the encoders' noise."""

from dataclasses import replace

import numpy as np
import pytest
from transfer_floor import recorded, sinks
from transfer_sinking import sinking

from workbench.models import Ground, read_model


@pytest.mark.parametrize("seed", [3])
def test_the_damping_of_the_plate_is_within_its_interval(seed: int) -> None:
    law = sinks(read_model("leg"), seed)
    assert abs(law.damping - 150.0) < 1.5 * law.damping_half and law.damping_half < 25.0
    assert law.stiffness == pytest.approx(1e5, rel=0.01)


def test_more_noise_of_the_encoders_widens_the_interval() -> None:
    runs, generator = recorded(1), np.random.default_rng(4)
    leg = read_model("leg")
    leg = replace(leg, ground=Ground(("foot",), radius=0.02, height=-0.34))
    rough = [
        replace(r, signals={
            **r.signals,
            "position": r.signals["position"] + 3e-4 * generator.standard_normal(r.signals["position"].shape),
        })
        for r in runs
    ]  # fmt: skip
    fine, coarse = (sinking(leg, made, 0.25) for made in (runs, rough))
    assert coarse.damping_half > 2.0 * fine.damping_half
    assert abs(coarse.damping - 150.0) < 2.0 * coarse.damping_half
