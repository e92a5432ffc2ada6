"""Each kind of replay is taken for its recordings, and says to a search what it can show."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.free_motion import pendulum, recorded, swing
from workbench.comparison import Replay, followed, replay_of
from workbench.effects import effect_named, load_model
from workbench.rigs import Plate, VirtualLeg, chirp, plate_experiments

_BY_RUNS = ("ground_friction", "link_length_error")  # on the ground no torque along a motion


def replay(kind: str, folder: Path) -> Replay:
    """A replay of one short recording."""
    if kind == "FreeDecay":
        return replay_of(pendulum(folder), [recorded(swing(0.9, duration=5.0))])
    if kind == "ContactWindows":
        step = [e for e in plate_experiments(duration=0.4) if e.name == "step"]
        return replay_of(load_model("leg_on_plate"), VirtualLeg((), seed=2, plate=Plate()).run(step))
    made = VirtualLeg((), seed=2).run([chirp("knee", duration=1.0)])
    return replay_of(load_model("leg"), followed(made) if kind == "InverseDynamicsReplay" else made)


@pytest.mark.parametrize(
    ("kind", "simulates", "driven", "machine_alone", "smooth", "shown", "by_runs"),
    [
        ("ClosedLoop", True, True, True, True, {"backlash", "encoder_scale"}, set()),
        ("InverseDynamicsReplay", False, True, True, True, {"backlash", "encoder_scale"}, set()),
        ("FreeDecay", True, False, True, True, set(), set()),
        ("ContactWindows", True, True, False, False, {"ground_friction", "encoder_scale"}, {*_BY_RUNS}),
    ],
)  # fmt: skip
def test_what_a_kind_can_show(
    tmp_path: Path,
    kind: str,
    simulates: bool,
    driven: bool,
    machine_alone: bool,
    smooth: bool,
    shown: set[str],
    by_runs: set[str],
) -> None:
    found = replay(kind, tmp_path)
    assert type(found).__name__ == kind
    says = (found.simulates, found.driven, found.machine_alone, found.smooth)
    assert says == (simulates, driven, machine_alone, smooth)
    asked = ("backlash", "encoder_scale", "ground_friction")
    assert {e for e in asked if found.shows(e)} == shown, "what has a state that no sensor shows is not begun"
    assert {e for e in _BY_RUNS if found.needs_runs(effect_named(e))} == by_runs
