"""moteus: the frames of its documentation, and a virtual drive of other code, which understands the same."""

from __future__ import annotations

import math
import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from workbench.can import Feedback, Frame, FrameError, Parameter, Ranges, Read, Setpoint
from workbench.can.moteus import Moteus
from workbench.rigs.moteus_drive import MoteusDrive

RANGES = Ranges(12.0, 40.0, 20.0, 60.0, 2.0, "the drive's configuration")
FLOAT, INT16 = Moteus(1, 0, RANGES), Moteus(1, 0, RANGES, registers="int16")
EVERY = pytest.mark.parametrize("drive", [FLOAT, INT16], ids=["float", "int16"])
#: Steps of position, velocity, kp, kd and torque; floats have 24 bits.
STEPS = {
    "int16": (1e-4 * math.tau, 2.5e-4 * math.tau, 60.0 / 32767, 2.0 / 32767, 1e-2),
    "float": (1e-6, 4e-6, 4e-6, 2e-7, 2e-6),
}
PART = st.floats(-1.0, 1.0)


def virtual() -> MoteusDrive:
    """The other side; it remembers what it was told, and is therefore made anew."""
    return MoteusDrive(1, 0, RANGES)


def understood(frame: Frame) -> Setpoint:
    """The setpoint that the virtual drive takes from a frame."""
    got = virtual().asked(frame)
    assert got[1] == "enable" and isinstance(got[2], Setpoint)
    assert got[0] == Parameter("watchdog", pytest.approx(0.02, rel=1e-6))
    return got[2]


def steps(drive: Moteus) -> tuple[float, ...]:
    return STEPS["float" if drive is FLOAT else "int16"]


@EVERY
@given(p=PART, v=PART, t=PART, gains=st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)))
def test_a_setpoint_comes_back_to_half_a_step(drive, p, v, t, gains) -> None:
    kp, kd = max(gains), min(gains)  # the drive takes no more of its range of kd than of kp
    sent = Setpoint(12.0 * p, 40.0 * v, 60.0 * kp, 2.0 * kd, 20.0 * t)
    for got in (drive.asked(drive.command(sent)), understood(drive.command(sent))):
        assert isinstance(got, Setpoint)
        for a, b, step in zip(sent, got, steps(drive), strict=True):
            assert abs(a - b) <= 0.5 * step * (1 + 1e-6)


@EVERY
@given(p=PART, v=PART, t=PART, hot=st.integers(-20, 120), on=st.booleans())
def test_feedback_comes_back_to_half_a_step(drive, p, v, t, hot, on) -> None:
    said = Feedback(12.0 * p, 40.0 * v, 20.0 * t, float(hot), on)
    other = virtual()
    other.asked(drive.command(Setpoint(0, 0, 0, 0, 0)))
    [frame] = other.answer(said)
    got = drive.decode(frame)
    assert isinstance(got, Feedback) and got[3:] == (hot, on, 0) and frame.fd
    assert len(frame.data) <= drive.exchange[1].length, "no longer than the load counts"
    for a, b, step in zip(said[:3], got[:3], np.array(steps(drive))[[0, 1, 4]], strict=True):
        assert abs(a - b) <= 0.5 * step * (1 + 1e-6)


def test_the_example_of_its_documentation() -> None:
    got = Moteus(1, 0, RANGES).decode(Frame(0x100, bytes.fromhex("2404000a005000000170ff230d181400")))
    assert got == Feedback(
        pytest.approx(math.radians(2.88)), pytest.approx(math.radians(23.04)), pytest.approx(-1.44),
        20.0, True, 0,
    )  # fmt: skip
    command = Frame(0x8001, bytes.fromhex("01000a07206000200150ff140400130d"), True)
    asked = Moteus(1, 0, RANGES).asked(command)
    expected = math.radians(3.456), math.radians(25.92), 60.0, 2.0, -1.76
    assert asked == pytest.approx(Setpoint(*expected)), "gains that are not written are whole"


def test_frames_byte_for_byte() -> None:
    sent = INT16.command(Setpoint(0.01 * math.tau, -0.25 * math.tau, 30.0, 1.0, 1.5))
    body = "01000a040620640018fc960000400040d00705271400140400130d"
    assert sent == Frame(0x8001, bytes.fromhex(body).ljust(32, b"\x50"), True, fd=True)
    assert INT16.exchange[0].length == 32 and FLOAT.exchange[0].length == 48
    stop = FLOAT.act("disable")
    assert stop.data == bytes.fromhex("0100001c0400130d") and stop.extended
    assert FLOAT.read("watchdog").data == bytes.fromhex("1d27")
    assert FLOAT.act("zero").data == bytes.fromhex("0db00200000000").ljust(7, b"\x50")


@EVERY
@pytest.mark.parametrize(
    "setpoint", [Setpoint(1, 2, 30, 1, 3), Setpoint(1, 0, 0, 0, 3), Setpoint(1, 0, 0, 2, 0)]
)
def test_its_watchdog_goes_with_every_command(drive, setpoint: Setpoint) -> None:
    data = drive.command(setpoint).data
    said = b"\x0d\x27" + struct.pack("<f", 0.02) if drive is FLOAT else b"\x05\x27\x14\x00"
    assert said in data and len(data) in (12, 16, 20, 24, 32, 48, 64)


def test_its_watchdog_is_read_back_and_can_be_none_that_is_off() -> None:
    assert FLOAT.asked(FLOAT.read("watchdog")) == Read("watchdog")
    other = virtual()
    assert other.asked(FLOAT.write(Parameter("watchdog", 0.02)))[1] == "clear", "stopped while it is told"
    assert other.asked(FLOAT.read("watchdog")) == ["look"]
    [frame] = other.answer(Feedback(0, 0, 0))
    assert FLOAT.decode(frame) == Parameter("watchdog", pytest.approx(0.02))
    with pytest.raises(FrameError, match=r"cannot be set to a watchdog of 0\.5"):
        FLOAT.write(Parameter("watchdog", 0.5))
    for bad in (0.0, math.nan, -1.0, math.inf):
        with pytest.raises(FrameError, match="watchdog"):
            Moteus(1, 0, RANGES, bad)
    with pytest.raises(FrameError, match="do not report their mode"):
        FLOAT.read("mode")


@EVERY
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e6, -1e6])
@pytest.mark.parametrize("field", range(5))
def test_what_is_no_number_or_beyond_the_ranges_is_refused(drive, bad, field) -> None:
    values = [0.0] * 5
    values[field] = bad
    with pytest.raises(FrameError):
        drive.command(Setpoint(*values))


def test_damping_without_stiffness_is_a_mode_or_nothing() -> None:
    damp = Setpoint(0.3, 0.0, 0.0, 2.0, 0.0)
    assert FLOAT.command(damp).data[:3] == b"\x01\x00\x0c"
    assert FLOAT.asked(FLOAT.command(damp)) == understood(FLOAT.command(damp)) == (0, 0, 0, 2.0, 0)
    for wanted in (damp._replace(kd=1.0), damp._replace(torque=1.0), damp._replace(kp=30.0)):
        with pytest.raises(FrameError, match="more of its range"):
            FLOAT.command(wanted)


@EVERY
def test_actions_are_understood(drive) -> None:
    assert drive.asked(drive.act("disable")) == drive.asked(drive.act("clear")) == "disable"
    assert drive.asked(drive.act("zero")) == "zero" and virtual().asked(drive.act("zero")) == ["zero"]
    assert virtual().asked(drive.act("disable"))[1] == "clear"
    assert drive.asked(drive.act("enable")) == Setpoint(0, 0, 0, 0, 0)


def test_modes_and_faults_are_told() -> None:
    def said(mode: int, fault: int = 0) -> Feedback:
        got = FLOAT.decode(Frame(0x100, bytes([0x24, 4, 0, mode, 0, *bytes(6), 0x23, 0x0D, 48, 30, fault])))
        assert isinstance(got, Feedback)
        return got

    assert [said(mode).enabled for mode in (0, 10, 11, 12)] == [False, True, False, True]
    assert said(1, 38).fault == 38 and FLOAT.explain(38) == "hot" and not said(1, 38).enabled
    assert said(1).fault != 0, "a fault without a number is one"
    assert said(10, 99).fault == 0, "only says what limits it"
    assert FLOAT.explain(said(11).fault) == "no command within its watchdog"


@pytest.mark.parametrize(
    "data",
    ["24", "2404", "240400", "2404000a", "2404000a0050000001ff", "30", "300101", "60", "2fff", "24ffffffffff",
     "140400", "2c04000000c07f000000000000000000000000"],
)  # fmt: skip
def test_what_is_cut_off_or_no_answer_is_refused(data: str) -> None:
    with pytest.raises(FrameError):
        FLOAT.decode(Frame(0x100, bytes.fromhex(data)))


def test_frames_of_others_are_left_to_them() -> None:
    sent, other = FLOAT.command(Setpoint(0, 0, 0, 0, 0)), virtual()
    other.asked(sent)
    [said] = other.answer(Feedback(0, 0, 0))
    for bit in range(15):
        assert virtual().asked(sent._replace(id=sent.id ^ 1 << bit)) == []
        assert FLOAT.asked(sent._replace(id=sent.id ^ 1 << bit)) is None
        assert FLOAT.decode(said._replace(id=said.id ^ 1 << bit)) is None
    assert FLOAT.decode(sent) is None and FLOAT.asked(said) is None
    for ids in ((1, 1), (0x80, 0), (1, 0x80), (-1, 0)):
        with pytest.raises(FrameError):
            Moteus(*ids, RANGES)


def test_a_drive_that_lost_its_host_or_is_hot_says_which() -> None:
    for own, said in ((0xD, "no command within its watchdog"), (0xC, "hot"), (33, "motor driver")):
        other = virtual()
        other.asked(FLOAT.act("clear"))
        [frame] = other.answer(Feedback(0, 0, 0, 30.0, False, own))
        got = FLOAT.decode(frame)
        assert isinstance(got, Feedback) and FLOAT.explain(got.fault) == said and got.enabled is False


def test_no_more_than_the_torque_that_a_command_allows() -> None:
    wide = Moteus(1, 0, Ranges(12.0, 40.0, 20.0, 60.0, 2.0, "x"))
    frame = wide.command(Setpoint(0, 0, 0, 0, 20.0))
    assert understood(frame).torque == pytest.approx(20.0)


@given(st.binary(max_size=64))
def test_random_frames_raise_nothing_unexpected(data: bytes) -> None:
    FLOAT.asked(Frame(0x8001, data, True))
    virtual().asked(Frame(0x8001, data, True, fd=True))
    try:
        FLOAT.decode(Frame(0x100, data))
    except FrameError:
        return


def test_every_fault_that_is_published_has_its_name() -> None:
    named = {
        11: "no command within its watchdog", 32: "calibration", 33: "motor driver", 34: "over-voltage",
        35: "encoder", 36: "not configured", 37: "PWM overrun", 38: "hot", 39: "outside its limits",
        40: "under-voltage", 41: "configuration changed", 42: "commutation encoder", 43: "output encoder",
        44: "driver enable", 45: "stop position", 46: "timing", 47: "feedforward without acceleration",
        48: "invalid limits",
    }  # fmt: skip
    assert {number: FLOAT.explain(number) for number in named} == named and FLOAT.explain(7) == "number 7"


@pytest.mark.parametrize("kind", range(4), ids=["int8", "int16", "int32", "float"])
def test_answers_of_every_type_mean_the_same(kind: int) -> None:
    # 0.25 turns, 0.5 turns a second, -1.5 N m, 31 degrees, as the registers' table has their steps
    steps = ((0.01, 1e-4, 1e-5, 1.0), (0.1, 2.5e-4, 1e-5, 1.0), (0.5, 0.01, 1e-3, 1.0), (1.0, 0.1, 1e-3, 1.0))
    values, letter = (0.25, 0.5, -1.5, 31.0), "bhif"[kind]
    raw = [value / step[kind] for value, step in zip(values, steps, strict=True)]
    p, v, t, hot = (struct.pack("<" + letter, each if kind == 3 else round(each)) for each in raw)
    mode = struct.pack("<" + letter, 10)
    data = bytes([0x20 | kind << 2, 4, 0]) + mode + p + v + t + bytes([0x20 | kind << 2 | 1, 14]) + hot
    got = FLOAT.decode(Frame(0x100, data, fd=True))
    assert got == (pytest.approx(0.25 * math.tau), pytest.approx(0.5 * math.tau), -1.5, 31.0, True, 0)


@pytest.mark.parametrize("kind", range(4), ids=["int8", "int16", "int32", "float"])
def test_commands_of_every_type_are_read_in_a_log(kind: int) -> None:
    steps = (
        (0.01, 1e-4, 1e-5, 1.0), (0.1, 2.5e-4, 1e-5, 1.0), (0.5, 0.01, 1e-3, 1.0),
        (1 / 127, 1 / 32767, 1 / 2147483647, 1.0), (1 / 127, 1 / 32767, 1 / 2147483647, 1.0),
    )  # fmt: skip
    values, letter = (0.25, 0.5, -1.5, 1.0, 0.5), "bhif"[kind]
    raw = [value / step[kind] for value, step in zip(values, steps, strict=True)]
    body = b"".join(struct.pack("<" + letter, each if kind == 3 else round(each)) for each in raw)
    frame = Frame(0x8001, bytes([0x01, 0, 10, kind << 2, 5, 0x20]) + body, True, fd=True)
    wanted = (0.25 * math.tau, 0.5 * math.tau, 60.0, 1.0, -1.5)
    assert FLOAT.asked(frame) == pytest.approx(wanted, rel=0.02)
    [_, _, setpoint] = virtual().asked(frame)
    assert setpoint == pytest.approx(wanted, rel=0.02)


def test_its_exchange_is_as_long_as_its_frames() -> None:
    assert [(c.length, c.extended, c.fd) for c in FLOAT.exchange] == [(48, True, True), (24, False, True)]
    assert [(c.length, c.extended, c.fd) for c in INT16.exchange] == [(32, True, True), (16, False, True)]
    assert Moteus(8, 0, RANGES).exchange[1].extended and not Moteus(7, 0x7F, RANGES).exchange[1].extended
    assert FLOAT.claims == {(0x8001, True), (0x100, False)}
    assert Moteus(8, 1, RANGES).claims == {(0x8108, True), (0x801, True)}
    assert FLOAT.torque_step < INT16.torque_step == 0.01


@pytest.mark.parametrize("kind", range(3), ids=["int8", "int16", "int32"])
def test_the_most_negative_integer_is_no_number(kind: int) -> None:
    least, letter = -(2 ** (8 << kind) // 2), "bhi"[kind]

    def velocity(raw: int) -> float:
        words = b"".join(struct.pack("<" + letter, each) for each in (10, 0, raw, 0))
        got = FLOAT.decode(Frame(0x100, bytes([0x20 | kind << 2, 4, 0]) + words, fd=True))
        assert isinstance(got, Feedback)
        return got.velocity

    assert math.isnan(velocity(least)) and velocity(least + 1) < 0.0
