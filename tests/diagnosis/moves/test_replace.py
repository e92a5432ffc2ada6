"""What was taken while another cause was missing is held against others once that cause is there."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.diagnosis.rig import SPRING_AND_DELAY, applied, asked, explored_from, recordings
from workbench.core import EffectKey
from workbench.diagnosis.moves.replace import replaced
from workbench.effects import load_model

LEG = load_model("leg")
PIN, DRIVE = (EffectKey("joint_compliance", "knee", place) for place in ("joint", "actuator"))
DELAY = EffectKey("sensor_delay", None)


def test_a_spring_at_the_drive_is_found_instead_of_the_pin_s() -> None:
    pin, late = applied(LEG, PIN, stiffness=85.0, damping=0.1), applied(LEG, DELAY, time=0.0012)
    problem = asked(LEG, *recordings(*SPRING_AND_DELAY))
    found = explored_from(problem, pin, late, loss_ratios=((DRIVE, 1.007),))
    assert found.done
    values = {a.key: a.values for a in found.current.hypothesis.free}
    assert values.keys() == {DRIVE, DELAY}
    assert values[DRIVE]["stiffness"] == pytest.approx(91.0, rel=0.01)
    last = found.steps[-1]
    assert last.added == DRIVE and last.dropped == (PIN,)
    assert dict(last.loss_ratios)[PIN] > 1.5, "how far the one given up is behind"

    def tried(text: str) -> None:
        raise AssertionError(text)

    asked_again = replace(problem, progress=tried)
    far = tuple(replace(step, loss_ratios=((PIN, 2.6),)) for step in found.steps)
    assert not list(replaced(replace(found, steps=far), asked_again)), "what was far behind is not tried"
    close = tuple(replace(step, loss_ratios=((PIN, 1.1),)) for step in found.steps)
    with pytest.raises(AssertionError, match="in place of"):
        next(replaced(replace(found, steps=close), asked_again))
