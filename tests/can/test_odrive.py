"""ODrive: its table of messages, byte by byte, and a virtual drive of other code, which understands it."""

from __future__ import annotations

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workbench.can import Feedback, Frame, FrameError, Parameter, Ranges, Read, Setpoint
from workbench.can.messages import Action
from workbench.can.odrive import Endpoints, Odrive
from workbench.rigs.odrive_drive import OdriveDrive

RANGES = Ranges(12.0, 40.0, 20.0, 60.0, 2.0, "its configuration")
ENDS = Endpoints(481, 482)
NODE = 5
PART = st.floats(-1.0, 1.0)
ACTIONS: tuple[Action, ...] = ("enable", "disable", "zero", "clear")


def drive(ends: Endpoints | None = ENDS) -> Odrive:
    return Odrive(NODE, RANGES, ends)


def virtual(enabled: bool = True) -> OdriveDrive:
    made = OdriveDrive(NODE, RANGES, *ENDS)
    for frame in drive().act("enable") if enabled else ():
        made.asked(frame)
    return made


def float_(value: float) -> bytes:
    return struct.pack("<f", value)


@given(p=PART, v=PART, t=PART, kp=st.floats(0.0, 1.0), kd=st.floats(1e-3, 1.0))
def test_a_setpoint_is_understood_by_both_to_half_a_step(p, v, t, kp, kd) -> None:
    sent = Setpoint(12.0 * p, 40.0 * v, 60.0 * kp, 2.0 * kd, 20.0 * t)
    codec, other, steps = drive(), virtual(), (2e-6, 2e-3 * math.pi, 1e-5, 1e-6, 1e-3)
    for frame in codec.command(sent):
        logged, done = codec.asked(frame), other.asked(frame)
        if done and isinstance(done[0], Setpoint):
            for got in (logged, done[0]):
                assert isinstance(got, Setpoint)
                for a, b, step in zip(sent, got, steps, strict=True):
                    assert abs(a - b) <= 0.5 * step * (1 + 1e-3)
            return
    raise AssertionError("no setpoint came out")


@given(p=PART, v=PART, t=PART, hot=st.floats(-20.0, 120.0), on=st.booleans())
def test_feedback_is_whole_once_motion_and_torque_are_told(p, v, t, hot, on) -> None:
    said = Feedback(12.0 * p, 40.0 * v, 20.0 * t, hot, on)
    codec, other = drive(), virtual()
    for frame in other.unasked(said, 0.0):
        assert codec.decode(frame) is None, "state and temperature alone are no feedback"
    for frame in codec.act("disable"):
        other.asked(frame)
    motion, torques = other.answer(said)
    assert codec.decode(motion) is None
    got = codec.decode(torques)
    assert isinstance(got, Feedback) and got.enabled is on and got.fault == 0
    assert got[:4] == pytest.approx(said[:4], rel=1e-6, abs=1e-6)
    assert codec.decode(torques) is None, "the same torque again is no new feedback"


def test_frames_byte_by_byte() -> None:
    sent = drive().command(Setpoint(math.pi, -math.tau, 4.0, 2.0, 1.5))
    assert sent == (
        Frame(0xBA, float_(2.0) + bytes(4)), Frame(0xBB, float_(2.0 * math.tau) + bytes(4)),
        Frame(0xAC, float_(0.5) + struct.pack("<hh", -1000, 1500)),
        Frame(0xA9, b"", remote=True), Frame(0xBC, b"", remote=True),
    )  # fmt: skip
    enable = (Frame(0xAB, struct.pack("<II", 3, 1)), Frame(0xA7, struct.pack("<I", 8)))
    assert drive().act("enable") == enable
    assert drive().act("disable")[0] == Frame(0xA7, struct.pack("<I", 1))
    assert drive().act("clear") == (Frame(0xB8, b"\0"),)
    assert drive().act("zero") == (Frame(0xB9, bytes(4)),)
    asked = struct.pack("<BHB", 0, 481, 0), struct.pack("<BHB", 0, 482, 0)
    assert [frame.data for frame in drive().read("watchdog")] == list(asked)
    told = struct.pack("<BHBf", 1, 481, 0, 0.02), struct.pack("<BHBB", 1, 482, 0, 1)
    written = drive().write(Parameter("watchdog", 0.02))
    assert [frame.data for frame in written] == list(told) and {f.id for f in written} == {0xA4}
    assert len(sent) == 5 and sum(f.hz == 0 for f in drive().exchange) == 5 + 2, "as the load counts"


def test_its_watchdog_is_set_switched_on_and_read_back() -> None:
    codec, other = drive(), virtual(False)

    def read() -> object:
        got = []
        for frame in codec.read("watchdog"):
            assert other.asked(frame) == ["look"]
        for frame in other.answer(Feedback(0, 0, 0)):
            got.append(codec.decode(frame))
        assert got[0] is None, "one endpoint is half of it"
        return got[1]

    assert read() == Parameter("watchdog", 0.0), "off is the factory setting"
    timeout, enable = codec.write(Parameter("watchdog", 0.02))
    other.asked(timeout)
    assert read() == Parameter("watchdog", 0.0), "a time without the switch is none"
    assert other.asked(enable) == [Parameter("watchdog", pytest.approx(0.02))]
    assert read() == Parameter("watchdog", pytest.approx(0.02))
    for bad in (0.0, math.nan, -1.0, math.inf):
        with pytest.raises(FrameError, match="watchdog"):
            codec.write(Parameter("watchdog", bad))
    with pytest.raises(FrameError, match="does not report"):
        drive(None).read("watchdog")
    with pytest.raises(FrameError, match="cannot be set"):
        drive(None).write(Parameter("watchdog", 0.02))
    assert drive(None).parameters == () and codec.parameters == ("watchdog",)


def answers(codec: Odrive, other: OdriveDrive, said: Feedback) -> object:
    for frame in codec.act("disable"):
        other.asked(frame)
    return [codec.decode(frame) for frame in other.answer(said)][-1]


def test_a_drive_that_no_longer_tells_its_state_says_nothing() -> None:
    said = Feedback(0.1, 0.2, 0.3, 30.0, True)
    codec, other = drive(), virtual()
    assert answers(codec, other, said) is None, "not before its state is known"
    beat, warm = other.unasked(said, 0.0)
    codec.decode(beat)
    assert answers(codec, other, said) is None, "nor its temperature"
    codec.decode(warm)
    for _ in range(12):
        assert answers(codec, other, said) is not None
    assert answers(codec, other, said) is None
    for _ in range(33):
        codec.decode(beat)
        for _ in range(12):
            heard = answers(codec, other, said)
    assert heard is None, "four hundred feedbacks without a temperature"
    codec.decode(beat)
    codec.decode(warm)
    assert answers(codec, other, said) is not None


def test_what_it_says_by_itself_comes_at_its_pace() -> None:
    other, said = virtual(), Feedback(0, 0, 0, 30.0, True)
    ids = [frame.id & 31 for k in range(1000) for frame in other.unasked(said, k * 1e-3)]
    assert ids.count(1) == 100 and ids.count(0x15) == 10


@pytest.mark.parametrize(
    ("own", "words"),
    [(0xD, "no command within its watchdog"), (0xC, "hot MOSFET"), (0x300, "over-voltage, under-voltage")],
)  # fmt: skip
def test_its_errors_have_names(own: int, words: str) -> None:
    said = Feedback(0, 0, 0, 30.0, False, own)
    codec, other = drive(), virtual()
    for frame in other.unasked(said, 0.0):
        codec.decode(frame)
    got = answers(codec, other, said)
    assert isinstance(got, Feedback) and got.enabled is False and codec.explain(got.fault) == words
    assert codec.explain(1 << 31) == f"number {1 << 31}"


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e6, -1e6])
@pytest.mark.parametrize("field", range(5))
def test_what_is_no_number_or_beyond_the_ranges_is_refused(bad, field) -> None:
    values = [0.0, 0.0, 0.0, 1.0, 0.0]
    values[field] = bad
    with pytest.raises(FrameError):
        drive().command(Setpoint(*values))


def test_stiffness_needs_damping_and_ranges_need_room() -> None:
    with pytest.raises(FrameError, match="needs damping"):
        drive().command(Setpoint(0, 0, 1.0, 0.0, 0))
    for wrong in ({"torque": 33.0}, {"velocity": 210.0}):
        with pytest.raises(FrameError, match="no frame carries"):
            Odrive(1, Ranges(**{**vars(RANGES), **wrong}))
    Odrive(0x3E, Ranges(**{**vars(RANGES), "torque": 32.767, "velocity": 205.8}))
    for id in (-1, 0x3F):
        with pytest.raises(FrameError, match="0 to 0x3E"):
            Odrive(id, RANGES)


def test_an_input_in_another_mode_is_none() -> None:
    other = virtual(False)
    got = [each for frame in drive().command(Setpoint(1, 0, 4, 2, 3)) for each in other.asked(frame)]
    assert got[0] == Setpoint(0, 0, 0, 0, 0)


def test_frames_of_others_are_left_to_them() -> None:
    codec, said = drive(), Frame(NODE << 5 | 9, bytes(8))
    for wrong in (
        said._replace(extended=True), said._replace(fd=True), said._replace(remote=True, data=b""),
        said._replace(id=(NODE + 1) << 5 | 9), said._replace(id=NODE << 5 | 30),
        said._replace(id=NODE << 5 | 7),
    ):  # fmt: skip
        assert codec.decode(wrong) is None
    assert codec.decode(Frame(NODE << 5 | 28, bytes(8))) is None and codec.asked(said) is None
    with pytest.raises(FrameError, match="answer of 7 bytes"):
        codec.decode(said._replace(data=bytes(7)))
    assert codec.claims == {(NODE << 5 | k, False) for k in range(32)}


@given(st.integers(0, 0x7FF), st.binary(max_size=8), st.booleans())
def test_random_frames_raise_nothing_unexpected(id: int, data: bytes, remote: bool) -> None:
    frame = Frame(NODE << 5 | id & 31, b"" if remote else data, remote=remote)
    codec = drive()
    codec.asked(frame)
    virtual().asked(frame)
    try:
        codec.decode(frame)
    except FrameError:
        return


def test_every_error_that_is_published_has_its_name() -> None:
    named = {
        1: "not started", 1 << 1: "system", 1 << 2: "timing", 1 << 3: "no estimate",
        1 << 4: "bad configuration",
        1 << 5: "gate driver", 1 << 6: "no input", 1 << 8: "over-voltage", 1 << 9: "under-voltage",
        1 << 10: "over-current of the supply", 1 << 11: "too much current fed back", 1 << 12: "over-current",
        1 << 13: "hot motor", 1 << 14: "hot MOSFET", 1 << 15: "too fast", 1 << 16: "outside its limits",
        1 << 24: "no command within its watchdog", 1 << 25: "emergency stop", 1 << 26: "encoder slipped",
        1 << 27: "brake resistor", 1 << 28: "no thermistor", 1 << 30: "calibration",
    }  # fmt: skip
    assert {bit: drive().explain(bit) for bit in named} == named


def test_its_exchange_and_what_a_log_shows_of_actions() -> None:
    lengths = [len(frame.data) for frame in drive().command(Setpoint(0, 0, 0, 0, 0))]
    once = [each.length for each in drive().exchange if not each.hz]
    assert once == [8, 8, 8, 0, 0, 8, 8] and sorted(lengths) == [0, 0, 8, 8, 8]
    assert [(each.length, each.hz) for each in drive().exchange if each.hz] == [(8, 100.0), (8, 10.0)]
    codec = drive()
    shown = [codec.asked(codec.act(action)[-1 if action == "enable" else 0]) for action in ACTIONS]
    assert shown == list(ACTIONS)
    assert [codec.asked(frame) for frame in codec.read("watchdog")] == [Read("watchdog")] * 2
    assert Odrive(0, RANGES).claims == {(k, False) for k in range(32)}


def test_four_hundred_feedbacks_may_lack_a_temperature() -> None:
    said = Feedback(0.1, 0.2, 0.3, 30.0, True)
    codec, other = drive(), virtual()
    beat, warm = other.unasked(said, 0.0)
    codec.decode(warm)
    heard = []
    for _ in range(401):
        codec.decode(beat)
        heard.append(answers(codec, other, said) is not None)
    assert heard == [True] * 400 + [False]
