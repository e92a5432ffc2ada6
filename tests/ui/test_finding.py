"""What the live workbench offers to add: a gain that the recordings state is corrected in their files."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from tests.report import build
from workbench.core import EffectKey, Estimate, Finding
from workbench.ui.changes import Changes
from workbench.ui.finding import Findings
from workbench.ui.live import Live

from .conftest import Loop

GAIN, DAMPING = EffectKey("controller_gain_error", "knee"), EffectKey("viscous_damping", "knee")


def shown(part: Any) -> str:
    """All words of a part of the page, however deep."""
    own = [str(getattr(part, name, "") or "") for name in ("object", "name")]
    return " ".join([*own, *map(shown, getattr(part, "objects", None) or ())])


def test_a_gain_that_recordings_state_is_not_added(live: Live, loop: Loop) -> None:
    live.choose("leg", ("slow",), None)
    loop.until(lambda: live.now and live.now.entries)
    assert live.takes(DAMPING) and not live.takes(GAIN)
    changes = Changes(live)
    changes.follow()
    offered = set(changes.by_hand.options.values())
    assert DAMPING in offered and GAIN not in offered

    scales = {"kp_scale": Estimate(0.8, 0.001, ""), "kd_scale": Estimate(1.0, 0.001, "")}
    gain = Finding(GAIN, scales, 0.02, None, None, 0.9)
    damping = Finding(DAMPING, {"damping": Estimate(0.1, 0.001, "N*m*s/rad")}, 0.02, None, None, 0.9)
    made = build.improvement(seconds=1.0, rate=100.0).diagnosis
    assert made
    line = "correct slow.toml, line 9 ([controller]): kp of knee is 50 and should be 40"
    live.bench.diagnosis = replace(
        made, findings=(gain, damping), mend=(line,), mend_recordings=(GAIN,), ranking=((GAIN, 0.9),)
    )
    findings = Findings(live)
    findings.follow()
    words = shown(findings.view)
    assert "Add viscous damping on the knee drive" in words and "Add all of them" not in words
    assert "Add controller" not in words and "Fit controller" not in words
    assert "Correct slow.toml, line 9" in words and "Correct it in the files of the recordings" in words
