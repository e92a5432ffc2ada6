"""Whatever comes in, in any order: nothing leaves its limits, stale feedback damps, faults latch."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from workbench.deployment import Limits, SafetyState, Seen, Setpoints, Wanted, initial, step

TICK = 0.003
LIMITS = Limits(
    low=np.array([-1.0, 0.2]), high=np.array([1.0, 2.0]), velocity=np.array([20.0, 20.0]),
    torque=np.array([10.0, 5.0]), torque_rate=np.array([2000.0, 1000.0]), temperature=np.array([80.0, 80.0]),
    kp=np.array([500.0, 500.0]), kd=np.array([5.0, 5.0]), damping=np.array([1.0, 1.0]),
    stale_s=0.009, late_s=0.036, soft_start_s=0.1, tilt=1.0,
)  # fmt: skip


def seen(now: float = 0.0, **more: object) -> Seen:
    fine = Seen(
        now, position=np.array([0.1, 1.0]), velocity=np.zeros(2), temperature=np.array([30.0, np.nan]),
        age=np.full(2, 1e-3), faulty=np.zeros(2, bool),
    )  # fmt: skip
    return replace(fine, **more)


def wanted(torque=(1.0, -1.0), position=(0.1, 1.0), kp=(0.0, 0.0), kd=(0.0, 0.0), age: float = 0.0) -> Wanted:
    arrays = [np.array(x, float) for x in (position, (0.0, 0.0), kp, kd, torque)]
    return Wanted(Setpoints(*arrays), age)


def running() -> tuple[SafetyState, float]:
    """A state in phase run, and its time."""
    state, now = initial(2), 0.0
    while state.phase != "run":
        now += TICK
        state, _ = step(LIMITS, state, seen(now), wanted())
        assert now < 1.0
    return state, now


ANY = st.floats(allow_nan=True, allow_infinity=True)
NEAR = st.floats(-3.0, 3.0)
PAIR = st.tuples(st.one_of(NEAR, ANY), st.one_of(NEAR, ANY)).map(np.array)
GAIN = st.tuples(st.one_of(st.floats(0.0, 600.0), ANY), st.floats(0.0, 100.0)).map(np.array)
SEEN = st.builds(
    Seen,
    now=st.just(0.0),
    position=st.one_of(PAIR, st.just(np.array([0.1, 1.0]))),
    velocity=st.one_of(PAIR, st.just(np.zeros(2))),
    temperature=st.one_of(PAIR, st.just(np.zeros(2))),
    age=st.one_of(st.just(np.zeros(2)), PAIR),
    faulty=st.tuples(st.booleans(), st.booleans()).map(np.array),
    bus_ok=st.sampled_from([True, True, True, False]),
    stop=st.sampled_from([False, False, False, True]),
    arm=st.sampled_from([True, True, True, False]),
    verified=st.sampled_from([True, True, True, False]),
    base_age=st.sampled_from([0.0, 0.0, 0.0, 0.0085, 0.01, math.nan]),
)
FINE = st.builds(lambda p, q: seen(position=np.array([p, q])), st.floats(-1.04, 1.04), st.floats(0.17, 2.04))
WANTED = st.one_of(
    st.none(),
    st.builds(Wanted, st.builds(Setpoints, PAIR, PAIR, GAIN, GAIN, PAIR), st.sampled_from([0.0, 1.0])),
)


@settings(max_examples=400, deadline=None)
@given(st.lists(st.tuples(st.one_of(FINE, SEEN), WANTED, st.floats(0.0, 0.2)), min_size=1, max_size=25))
def test_no_output_is_ever_outside_its_limits(ticks) -> None:
    state, now = initial(2), 0.0
    for look, wish, later in ticks:
        now += later
        before, look = state, replace(look, now=now)
        state, out = step(LIMITS, state, look, wish)
        sent = np.array([out.position, out.velocity, out.kp, out.kd, out.torque])
        assert np.isfinite(sent).all()
        assert (out.position >= LIMITS.low).all() and (out.position <= LIMITS.high).all()
        assert (np.abs(out.velocity) <= LIMITS.velocity).all()
        assert (out.kp >= 0).all() and (out.kp <= LIMITS.kp).all()
        assert (out.kd >= 0).all() and (out.kd <= LIMITS.kd).all()
        room = LIMITS.torque * (1 + 1e-9) + 1e-9
        assert (np.abs(out.torque) <= room).all() and (np.abs(state.torque) <= room).all()
        if state.phase not in ("soft_start", "run"):
            assert not out.torque.any() and not out.kp.any()
        blind = not (look.age < LIMITS.stale_s).all() or not look.base_age < LIMITS.stale_s
        if blind or look.stop or not np.isfinite(look.position).all():
            assert state.phase in ("off", "damp")
        if before.phase == "damp" and before.asked:
            assert state.phase == "damp", "only asking anew leaves damp"


@given(st.lists(st.tuples(FINE, st.tuples(NEAR, NEAR), st.floats(0.0, 0.02)), min_size=2, max_size=20))
def test_torque_changes_no_faster_than_its_rate(ticks) -> None:
    state, now = running()
    for look, torque, later in ticks:
        now += later
        q, last = look.position, state.torque
        state, out = step(LIMITS, state, replace(look, now=now), wanted(torque))
        inside = (q > LIMITS.low) & (q < LIMITS.high)
        room = LIMITS.torque_rate * later + 1e-9
        assert (np.abs(out.torque - last)[inside] <= room[inside]).all() or state.phase == "damp"
        assert (out.torque[q >= LIMITS.high] <= 0).all() and (out.torque[q <= LIMITS.low] >= 0).all()


BEYOND = st.floats(1e-6, 0.04)  # rad outside a limit, short of a fault


@given(
    st.tuples(st.sampled_from(["low", "high"]), BEYOND),
    st.tuples(st.sampled_from(["low", "high"]), BEYOND),
    st.tuples(NEAR, NEAR),
    st.tuples(st.floats(0.1, 600.0), st.floats(0.1, 600.0)),
    st.tuples(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0)),
)
@example(("high", 0.04), ("high", 0.04), (1.0, 2.0), (500.0, 500.0), (0.0, 0.0))
def test_beyond_a_position_limit_the_torque_limit_still_holds(first, second, aim, kp, torque) -> None:
    state, now = running()
    sides = [(side == "high", apart) for side, apart in (first, second)]
    q = np.array(
        [LIMITS.high[k] + apart if high else LIMITS.low[k] - apart for k, (high, apart) in enumerate(sides)]
    )
    back = np.array([-1.0 if high else 1.0 for high, _ in sides])
    for _ in range(20):  # the rate lets the whole torque through
        now += TICK
        state, out = step(LIMITS, state, seen(now, position=q), wanted(torque, aim, kp))
        assert state.phase == "run"
        total = out.torque + out.kp * (out.position - q)
        assert (np.abs(total) <= LIMITS.torque * (1 + 1e-9)).all()
        assert (total * back >= -1e-9).all(), "and leads back"


@pytest.mark.parametrize("kp", [0.0, 300.0])
def test_what_is_within_limits_goes_out_as_it_is(kp: float) -> None:
    state, now = running()
    wish = wanted((2.0, -1.0), (0.105, 0.996), (kp, kp), (1.0, 1.0))
    for _ in range(5):
        now += TICK
        state, out = step(LIMITS, state, seen(now), wish)
    if kp:
        assert out.position == pytest.approx(wish.setpoints.position)
    assert out.torque == pytest.approx([2.0, -1.0]) and out.kp == pytest.approx([kp, kp])


FAULTS = {
    "no feedback": {"age": np.array([0.009, 0.0])},
    "never heard": {"age": np.array([np.inf, 0.0])},
    "age unknown": {"age": np.array([np.nan, 0.0])},
    "no data of the base": {"base_age": 0.009},
    "no number": {"position": np.array([np.nan, 1.0])},
    "no speed": {"velocity": np.array([0.0, -np.inf])},
    "drive": {"faulty": np.array([False, True])},
    "bus": {"bus_ok": False},
    "stop": {"stop": True},
    "position": {"position": np.array([0.0, 2.06])},
    "velocity": {"velocity": np.array([0.0, -20.1])},
    "temperature": {"temperature": np.array([80.5, 20.0])},
    "tilt": {"gravity": np.array([0.0, 0.9, 0.3])},
    "fall": {"carried": 0.29},
}


@pytest.mark.parametrize("carried", [0.3, 1.0, 3.0, math.nan])
def test_a_base_that_is_carried_or_unknown_is_no_fall(carried: float) -> None:
    state, now = running()
    state, _ = step(LIMITS, state, seen(now + TICK, carried=carried), wanted())
    assert state.phase == "run" and state.fault is None


@pytest.mark.parametrize("fault", FAULTS.values(), ids=FAULTS.keys())
def test_a_fault_damps_at_once_and_latches(fault: dict) -> None:
    state, now = running()
    state, out = step(LIMITS, state, seen(now + TICK, **fault), wanted())
    assert state.phase == "damp" and state.fault and not out.torque.any() and (out.kd == 1.0).all()
    for k in range(100):  # gone, and still asked for: nothing
        state, out = step(LIMITS, state, seen(now + (2 + k) * TICK), wanted())
        assert state.phase == "damp" and not out.torque.any() and not out.kp.any()
    later = now + 1.0
    state, _ = step(LIMITS, state, seen(later, arm=False), wanted())
    assert state.phase == "damp"
    state, _ = step(LIMITS, state, seen(later + TICK), wanted())
    assert state.phase == "arm" and state.fault is None


@pytest.mark.parametrize(
    "wish",
    [
        wanted((math.nan, 0.0)), wanted((math.inf, 0.0)), wanted((1e9, 0.0)),
        wanted(position=(1e3, 1.0), kp=(50, 50)),
        wanted(age=0.037), wanted(age=math.nan), None,
    ],
)  # fmt: skip
def test_an_action_that_no_policy_gives_damps_in_the_same_tick(wish) -> None:
    state, now = running()
    state, out = step(LIMITS, state, seen(now + TICK), wish)
    assert state.phase == "damp" and not out.torque.any() and not out.kp.any()


def test_a_late_policy_runs_until_two_of_its_periods() -> None:
    state, now = running()
    state, _ = step(LIMITS, state, seen(now + TICK), wanted(age=0.0359))
    assert state.phase == "run"


def test_start_is_soft_and_begins_where_the_axis_is() -> None:
    state, now, most = initial(2), 0.0, []
    for _ in range(60):
        now += TICK
        state, out = step(LIMITS, state, seen(now), wanted((8.0, 4.0)))
        if state.phase == "arm":
            assert out.position == pytest.approx([0.1, 1.0]) and not out.kp.any() and not out.torque.any()
        if state.phase == "soft_start":
            assert (out.torque <= (now - state.since) / 0.1 * np.array([8.0, 4.0]) + 1e-9).all()
        most.append(out.torque[0])
    assert state.phase == "run" and np.diff(most).max() < 0.3 and most[-1] == pytest.approx(8.0)


def test_nothing_moves_before_drives_are_verified() -> None:
    for more in ({"verified": False}, {"stop": True}):
        state, out = step(LIMITS, initial(2), seen(TICK, **more), wanted())
        assert state.phase == "off" and not (out.kp.any() or out.kd.any() or out.torque.any())
        state, _ = step(LIMITS, state, seen(2 * TICK), wanted())
        assert state.phase == "off", "released: no motion without asking anew"
