"""Noise of the states that windows start from pulls no parameter."""

from __future__ import annotations

from dataclasses import replace

from tests.diagnosis.test_grounded import MODEL
from workbench.core import EffectKey, Estimate
from workbench.diagnosis.data import gather
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.fitting.free_starts import with_free_starts
from workbench.diagnosis.hypothesis import Hypothesis
from workbench.models import AppliedEffect
from workbench.rigs import Plate, VirtualLeg, plate_experiments

LAW = EffectKey("contact_compliance", None)


def test_noise_of_starts_does_not_raise_a_grounds_damping() -> None:
    """What noise of the starts does dies sooner the more the ground damps, and the fit takes too much."""
    plate = Plate()
    press_step_slide = plate_experiments(duration=0.8)[:3]
    data, _ = gather(MODEL, VirtualLeg(seed=5001, plate=plate).run(press_step_slide), (), seed=1)
    assert MODEL.ground is not None
    open_ground = replace(MODEL, ground=replace(MODEL.ground, stiffness=None, damping=None))
    begin = {"stiffness": Estimate(plate.stiffness, 0.0, ""), "damping": Estimate(290.0, 0.0, "")}
    (pulled,) = fit([Hypothesis(open_ground, (AppliedEffect(LAW, begin),))], data)
    assert pulled is not None
    before, after = (
        f.hypothesis.free[0].parameters["damping"] for f in (pulled, with_free_starts(pulled, data))
    )
    assert before.value > plate.damping + 60.0
    assert abs(after.value - plate.damping) < min(30.0, 3.0 * after.std)
