"""Links that came out longer move pins, not mass; crank and coupler are told from the shank."""

import numpy as np
import pytest

from workbench.rigs import PERFECT, HiddenEffect, VirtualLeg, chirp, leg_structure
from workbench.rigs.leg_file import leg_file, leg_mass
from workbench.rigs.structure import linkage_share

SHANK, SHANK_CENTRE, THIGH = 0.23, 0.141006211, 0.175  # kg, m, m


def test_a_longer_thigh_carries_the_shank_further_out() -> None:
    """Knee pin and coupler end move by d: m d (2 l + d), m c d, m g d; nothing else changes."""
    d = 0.008
    added = leg_structure(longer=(d, 0.0)).minus(leg_structure())
    expected = {"m11": SHANK * d * (2 * THIGH + d), "m12": SHANK * SHANK_CENTRE * d, "g1": SHANK * 9.81 * d}
    for name, value in vars(added).items():
        assert value == pytest.approx(expected.get(name, 0.0), abs=1e-12)


def test_a_longer_shank_is_felt_by_its_payload_only() -> None:
    assert leg_structure(longer=(0.0, 0.01)) == leg_structure()
    loaded = leg_structure(0.3, (0.0, 0.01)).minus(leg_structure())
    assert loaded.m22 == pytest.approx(0.3 * 0.25**2)
    assert loaded.m12 == pytest.approx(0.3 * THIGH * 0.25)
    assert loaded.g2 == pytest.approx(0.3 * 9.81 * 0.25)


@pytest.mark.parametrize("order", [1, -1])
def test_payload_and_length_do_not_ask_which_came_first(order: int) -> None:
    both = [
        HiddenEffect("payload_mass", parameters={"mass": 0.2}),
        HiddenEffect("link_length_error", "hip", parameters={"length": 0.01}),
    ]
    (recording,) = VirtualLeg(both[::order], sensors=PERFECT).run([chirp("hip", duration=0.3)])
    (other,) = VirtualLeg(both[::-order], sensors=PERFECT).run([chirp("hip", duration=0.3)])
    np.testing.assert_array_equal(recording.position, other.position)


def test_crank_and_coupler_have_what_their_masses_say() -> None:
    share = linkage_share()
    assert share.m22 == pytest.approx(0.0003 + 0.05 * 0.03**2 + 0.05 * 0.06**2)
    assert share.m12 == pytest.approx(-0.05 * 0.06 * 0.0875)
    assert share.g2 == pytest.approx(-9.81 * 0.05 * (0.03 + 0.06))
    assert (share.m11, share.g1) == (0.0, 0.0)
    assert leg_mass() == pytest.approx(1.8 + 0.23 + 0.05 + 0.05)


def test_an_edited_file_is_gone_afterwards() -> None:
    with leg_file((0.01, 0.0)) as file:
        assert "-0.185" in file.read_text()
    assert not file.exists()
