"""Safety at the very edges: at a limit, at a threshold, with small gains, disarmed, upside down."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.deployment.test_safety import LIMITS, TICK, running, seen, wanted
from workbench.deployment import Setpoints, Wanted, initial, step


def after(wish: Wanted, ticks: int = 20, **more: object):
    """State and output once a running robot has wanted this for some ticks."""
    state, now = running()
    for _ in range(ticks):
        now += TICK
        state, out = step(LIMITS, state, seen(now, **more), wish)
    return state, out


@pytest.mark.parametrize("phase", ["arm", "soft_start", "run"])
def test_disarmed_it_damps_and_that_is_no_fault(phase: str) -> None:
    state, now = initial(2), 0.0
    while state.phase != phase:
        now += TICK
        state, _ = step(LIMITS, state, seen(now), None if phase == "arm" else wanted())
    state, out = step(LIMITS, state, seen(now + TICK, arm=False), wanted())
    assert state.phase == "damp" and state.fault is None
    assert not out.torque.any() and not out.kp.any() and (out.kd == 1.0).all()


def test_arming_in_vain_says_why() -> None:
    for more, said in (({"bus_ok": False}, "bus off"), ({"stop": True}, "emergency stop")):
        state, _ = step(LIMITS, initial(2), seen(TICK, **more), wanted())
        assert state.phase == "off" and state.fault and said in state.fault and state.axes == ()
    state, _ = step(LIMITS, initial(2), seen(TICK, temperature=np.array([20.0, 90.0])), wanted())
    assert state.phase == "off" and state.fault == "temperature limit" and state.axes == (1,)


def test_without_a_soft_start_it_runs_at_once() -> None:
    limits, state = replace(LIMITS, soft_start_s=0.0), initial(2)
    phases = []
    for k in range(1, 4):
        state, out = step(limits, state, seen(k * TICK), wanted((1.0, 1.0)))
        phases.append(state.phase)
    assert phases == ["arm", "run", "run"] and out.torque == pytest.approx([1.0, 1.0])


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_ten_times_a_limit_is_huge_and_a_little_less_is_clipped(axis: int, sign: float) -> None:
    middle, half = 0.5 * (LIMITS.low + LIMITS.high), 0.5 * (LIMITS.high - LIMITS.low)
    for times, phase in ((9.9, "run"), (10.1, "damp")):
        torque = np.zeros(2)
        torque[axis] = sign * times * LIMITS.torque[axis]
        state, _ = after(wanted(torque), 1)
        assert state.phase == phase
        position = middle.copy()
        position[axis] += sign * times * half[axis]
        for kp in (0.5, 50.0):
            state, _ = after(wanted(position=position, kp=(kp, kp)), 1)
            assert state.phase == phase and (phase == "run") == (state.fault is None)
        assert after(wanted(position=position), 1)[0].phase == "run", "without stiffness it means nothing"


def test_small_gains_and_speeds_go_out_as_they_are() -> None:
    wish = Setpoints(*map(np.array, ([0.12, 1.02], [2.0, -3.0], [0.5, 0.25], [0.3, 0.1], [0.1, 0.0])))
    _, out = after(Wanted(wish))
    for name in ("position", "velocity", "kp", "kd", "torque"):
        assert getattr(out, name) == pytest.approx(getattr(wish, name)), name


def test_speeds_and_gains_beyond_their_limits_are_clipped() -> None:
    wish = Setpoints(*map(np.array, ([0.1, 1.0], [21.0, -25.0], [600.0, -1.0], [6.0, -1.0], [0.0, 0.0])))
    _, out = after(Wanted(wish))
    assert out.velocity == pytest.approx([20.0, -20.0])
    assert out.kd == pytest.approx([5.0, 0.0]) and out.kp == pytest.approx([500.0, 0.0])


@pytest.mark.parametrize("beyond", [0.0, 0.01])
@pytest.mark.parametrize("high", [False, True])
def test_at_a_limit_no_torque_leads_out_and_none_is_made_up(high: bool, beyond: float) -> None:
    q, out_of = (LIMITS.high + beyond, 1.0) if high else (LIMITS.low - beyond, -1.0)
    for torque, expected in ((out_of * 3.0, 0.0), (0.0, 0.0), (-out_of * 3.0, -out_of * 3.0)):
        _, out = after(wanted((torque, torque)), position=q)
        assert out.torque == pytest.approx([expected, expected])


AIM = st.tuples(st.floats(-0.9, 0.9), st.floats(0.3, 1.9))


@given(AIM, st.lists(st.tuples(AIM, st.floats(1.0, 500.0)), min_size=2, max_size=10))
def test_a_spring_pulls_harder_no_faster_than_the_rate(q, aims) -> None:
    state, now = running()
    position = np.array(q)
    for aim, kp in aims:
        now, before = now + 5e-4, state.torque
        state, out = step(LIMITS, state, seen(now, position=position), wanted((0, 0), aim, (kp, kp)))
        total = out.torque + out.kp * (out.position - position)
        assert state.phase == "run" and state.torque == pytest.approx(total)
        grown = np.abs(total) - np.abs(before)
        assert (grown <= LIMITS.torque_rate * 5e-4 + 1e-9).all()


def test_tilted_is_by_the_angle_whatever_the_scale() -> None:
    for angle in (0.0, 0.5, 0.95, 1.05, 2.0, np.pi):
        for scale in (0.5, 1.0, 9.81):
            for about in (0.0, 1.0, 2.5):
                sideways = np.sin(angle) * np.array([np.cos(about), np.sin(about)])
                gravity = scale * np.array([*sideways, -np.cos(angle)])
                state, _ = after(wanted(), 1, gravity=gravity)
                assert state.phase == ("damp" if angle > LIMITS.tilt else "run"), (angle, scale)
                if angle > LIMITS.tilt:
                    assert state.fault == f"tilted by {np.degrees(angle):.0f} degrees, beyond 57"
