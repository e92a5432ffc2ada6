"""Effects that are hidden together sit apart, differ, and are the same for the same seed."""

import pytest
from exam.draw import draw_several

from workbench.core import InputError
from workbench.rigs import DRAWN_EFFECTS, VirtualLeg


@pytest.mark.parametrize("count", [2, 3])
def test_several_effects_sit_apart_and_are_not_much_the_same(count: int) -> None:
    sets = [draw_several(seed, count, DRAWN_EFFECTS) for seed in range(150)]
    assert sets[7] == draw_several(7, count, DRAWN_EFFECTS)
    for drawn in sets:
        assert len({(d.axis, d.location) for d in drawn}) == count
        VirtualLeg(drawn)  # the rig has room for them together
        assert not {"reflected_inertia", "linkage_inertia"} <= {d.effect for d in drawn}
    pairs = {tuple(sorted(d.effect for d in drawn)) for drawn in sets}
    assert len(pairs) > 100
    assert draw_several(1, count) != draw_several(2, count)


def test_more_effects_than_go_together_are_refused() -> None:
    with pytest.raises(InputError, match="no 2 of these effects can be combined"):
        draw_several(0, 2, ["command_delay", "payload_mass"])
