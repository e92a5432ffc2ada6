"""Every protocol: numbers come back to half a step, nothing that is no number is sent, known frames."""

import math
import struct

import cantools.database
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from workbench.can import (
    Damiao,
    Fault,
    Feedback,
    Frame,
    FrameError,
    Mit,
    Parameter,
    Ranges,
    Read,
    Robstride,
    Setpoint,
    Span,
    dbc,
)

AK = Ranges(12.5, 22.5, 25.0, 500.0, 5.0, "a manual")
DM4310 = Ranges(12.5, 30.0, 10.0, 500.0, 5.0, "a manual")
CYBERGEAR = Ranges(4 * math.pi, 30.0, 12.0, 500.0, 5.0, "a manual")
DRIVES = {
    "mit": Mit(3, 0, AK),
    "damiao": Damiao(1, 0x11, DM4310),
    "robstride": Robstride(0x7F, 0xFD, CYBERGEAR),
}
EVERY = pytest.mark.parametrize("drive", DRIVES.values(), ids=DRIVES.keys())
PART = st.floats(-1.0, 1.0)


def setpoint(drive, p: float, v: float, kp: float, kd: float, t: float) -> Setpoint:
    r = drive.ranges
    return Setpoint(p * r.position, v * r.velocity, abs(kp) * r.kp, abs(kd) * r.kd, t * r.torque)


@EVERY
@given(parts=st.tuples(PART, PART, PART, PART, PART))
def test_a_setpoint_comes_back_to_half_a_step(drive, parts) -> None:
    sent = setpoint(drive, *parts)
    frame = drive.command(sent)
    got = drive.asked(frame)
    assert isinstance(got, Setpoint), "no setpoint is taken for an action, not even of full scale"
    for span, a, b in zip(drive.fields, sent, got, strict=True):
        room = 0.5 if a < span.high - span.step else 1.5  # the last step of position is never sent
        assert abs(a - b) <= room * span.step * (1 + 1e-9)
    assert drive.command(got) == frame


@EVERY
@given(parts=st.tuples(PART, PART, PART), hot=st.integers(0, 120), enabled=st.booleans())
def test_feedback_comes_back_to_half_a_step(drive, parts, hot, enabled) -> None:
    r = drive.ranges
    said = Feedback(parts[0] * r.position, parts[1] * r.velocity, parts[2] * r.torque, hot, enabled)
    got = drive.decode(drive.answer(said))
    if drive.name == "damiao" and not enabled and isinstance(got, Parameter):
        return  # a disabled drive at the very end of its range looks like a register
    assert isinstance(got, Feedback)
    spans = (drive.fields.position, drive.fields.velocity, drive.fields.torque)
    for span, a, b in zip(spans, said[:3], got[:3], strict=True):
        assert abs(a - b) <= 0.5 * span.step * (1 + 1e-9)
    assert got.temperature == pytest.approx(hot) and got.enabled in (enabled, None) and got.fault == 0


@EVERY
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e6])
@pytest.mark.parametrize("field", range(5))
def test_what_no_frame_can_carry_is_refused(drive, bad, field) -> None:
    values = [0.0] * 5
    values[field] = bad
    with pytest.raises(FrameError):
        drive.command(Setpoint(*values))


@EVERY
def test_actions_are_understood(drive) -> None:
    for action in ("enable", "disable", "zero", "clear"):
        assert drive.asked(drive.act(action)) == action


@EVERY
def test_a_host_does_not_take_its_own_frames_for_answers(drive) -> None:
    frames = [drive.command(Setpoint(0, 0, 0, 0, 0)), *(drive.act(a) for a in ("enable", "disable"))]
    frames += [drive.read(name) for name in drive.parameters]
    for frame in frames:
        try:
            assert drive.decode(frame) is None
        except FrameError:
            pytest.fail("the drive's own command is not even an answer")


@pytest.mark.parametrize("drive", [DRIVES["damiao"], DRIVES["robstride"]])
def test_parameters_are_read_and_written(drive) -> None:
    for name in drive.parameters:
        value = {"watchdog": 0.02, "mode": 1.0, "position": 12.5, "velocity": 30.0, "torque": 10.0}[name]
        assert drive.asked(drive.read(name)) == Read(name)
        got = drive.asked(drive.write(Parameter(name, value)))
        assert got == Parameter(name, pytest.approx(value))
        confirmed = drive.confirm(Parameter(name, value))
        assert confirmed is None or drive.decode(confirmed) is None, "what was written proves nothing"
        assert drive.decode(drive.tell(Parameter(name, value))) == Parameter(name, pytest.approx(value))
        with pytest.raises(FrameError):
            drive.write(Parameter(name, math.nan))


def test_frames_as_published() -> None:
    assert DRIVES["mit"].act("enable") == Frame(3, b"\xff" * 7 + b"\xfc")
    # zero: the upper of the two middle steps, as 0x7FF 0x800 are alike
    assert DRIVES["mit"].command(Setpoint(0, 0, 0, 0, 0)).data == bytes.fromhex("8000800000000800")
    assert DRIVES["damiao"].read("watchdog") == Frame(0x7FF, bytes([1, 0, 0x33, 9, 0, 0, 0, 0]))
    written = DRIVES["damiao"].write(Parameter("watchdog", 0.02))
    assert written == Frame(0x7FF, bytes([1, 0, 0x55, 9]) + struct.pack("<I", 400))
    written = DRIVES["robstride"].write(Parameter("watchdog", 1.0))
    assert written == Frame(18 << 24 | 0xFD << 8 | 0x7F, struct.pack("<HHI", 0x7028, 0, 20000), True)
    command = DRIVES["robstride"].command(Setpoint(0, 0, 0, 0, 12.0))
    assert command.id == 1 << 24 | 0xFFFF << 8 | 0x7F and command.extended


def test_full_scale_is_no_action() -> None:
    full = Setpoint(AK.position, AK.velocity, AK.kp, AK.kd, AK.torque)
    span = DRIVES["mit"].fields.torque
    for raw in range(0xFF0, 0x1000):
        frame = DRIVES["mit"].command(full._replace(torque=span.decode(raw)))
        assert isinstance(DRIVES["mit"].asked(frame), Setpoint)


def test_zero_torque_is_half_a_step_away() -> None:
    span = DRIVES["mit"].fields.torque
    assert span.step == pytest.approx(0.0122, abs=5e-5)
    assert abs(span.decode(span.encode(0.0))) == pytest.approx(span.step / 2)


def test_faults_are_told() -> None:
    hot = Damiao(1, 0x11, DM4310).decode(Frame(0x11, bytes([0xB1, 128, 0, 128, 8, 0, 60, 120])))
    assert isinstance(hot, Feedback) and hot.fault == 0xB and not hot.enabled and hot.temperature == 120.0
    said = DRIVES["robstride"].answer(Feedback(0.0, 0.0, 0.0, 30.0, True, 0b100))
    got = DRIVES["robstride"].decode(said)
    assert isinstance(got, Feedback) and got.fault == 0b100 and got.enabled
    report = Frame(21 << 24 | 0x7F << 8 | 0xFD, struct.pack("<II", 9, 0), True)
    assert DRIVES["robstride"].decode(report) == Fault(9)


@pytest.mark.parametrize(
    ("drive", "frame"),
    [
        (DRIVES["mit"], Frame(0, b"\x03" + b"\0" * 4)),
        (DRIVES["damiao"], Frame(0x11, b"\x11" + b"\0" * 6)),
        (DRIVES["damiao"], Frame(0x11, b"\x31" + b"\x80" * 7)),
        (DRIVES["robstride"], Frame(2 << 24 | 0x7F << 8 | 0xFD, b"\0" * 7, True)),
        (DRIVES["robstride"], Frame(17 << 24 | 0x7F << 8 | 0xFD, b"\0" * 8, True)),
    ],
)
def test_garbage_of_a_drive_is_refused(drive, frame) -> None:
    with pytest.raises(FrameError):
        drive.decode(frame)


@pytest.mark.parametrize("length", [6, 7, 8])
def test_answers_of_every_firmware_are_read(length) -> None:
    drive = Mit(3, 0, AK, length=length)
    got = drive.decode(drive.answer(Feedback(1.0, -2.0, 3.0, 40.0, None, 7)))
    assert isinstance(got, Feedback) and got.position == pytest.approx(1.0, abs=2e-4)
    assert got.temperature == (None if length == 6 else 40.0)
    assert got.fault == (7 if length == 8 else 0)


def test_every_raw_number_comes_back() -> None:
    for span in (Span(-12.5, 12.5, 16), Span(-25.0, 25.0, 12), Span(0.0, 5.0, 12)):
        raw = np.arange(span.full + 1)
        assert all(span.encode(span.decode(int(r))) == r for r in raw)


def test_random_frames_raise_nothing_unexpected() -> None:
    generator = np.random.default_rng(4)
    for drive in DRIVES.values():
        ids = [drive.reply_id, drive.id] if not drive.extended else []
        for data in generator.integers(0, 256, (20_000, 12), dtype=np.uint8):
            id = int.from_bytes(data[8:].tobytes(), "big") & (0x1FFFFFFF if drive.extended else 0x7FF)
            id = ids[data[8] % 2] if ids and data[9] % 2 else id
            frame = Frame(id, data[: data[10] % 9].tobytes(), drive.extended)
            drive.asked(frame)
            try:
                got = drive.decode(frame)
            except FrameError:
                continue
            assert not isinstance(got, Feedback) or all(map(math.isfinite, got[:3]))


@pytest.fixture(scope="module")
def database():
    drives = {"hip": Mit(3, 0, AK), "knee": Mit(4, 0, AK), "left": Damiao(1, 0x11, DM4310),
              "right": Damiao(2, 0x11, DM4310), "toe": DRIVES["robstride"]}  # fmt: skip
    return drives, cantools.database.load_string(dbc(drives), "dbc")


@given(data=st.data())
def test_cantools_agrees_bit_for_bit(database, data) -> None:
    drives, description = database
    axis = data.draw(st.sampled_from(["hip", "knee", "left", "right"]))
    drive = drives[axis]
    raw = data.draw(st.tuples(*(st.integers(0, span.full - span.kept) for span in drive.fields)))
    values = Setpoint(*(span.decode(r) for span, r in zip(drive.fields, raw, strict=True)))
    frame = drive.command(values)
    message = description.get_message_by_name(f"command_{axis}")
    assert message.decode(frame.data, scaling=False) == dict(zip(values._fields, raw, strict=True))
    assert message.encode(dict(zip(values._fields, raw, strict=True)), scaling=False) == frame.data
    assert message.encode(values._asdict(), strict=False) == frame.data


@given(parts=st.tuples(PART, PART, PART), axis=st.sampled_from(["hip", "knee", "left", "right", "toe"]))
def test_cantools_reads_the_same_feedback(database, parts, axis) -> None:
    drives, description = database
    drive = drives[axis]
    r = drive.ranges
    said = Feedback(parts[0] * r.position, parts[1] * r.velocity, parts[2] * r.torque, 40.0, True)
    frame = drive.answer(said)
    got, read = drive.decode(frame), description.decode_message(frame.id, frame.data)
    assert isinstance(got, Feedback)
    names = [n if axis == "toe" else f"{n}_{axis}" for n in ("position", "velocity", "torque")]
    assert [read[name] for name in names] == pytest.approx(got[:3], rel=1e-12, abs=1e-12)


def test_faults_have_names() -> None:
    mit, damiao, robstride = (
        kind(1, 0x11, Ranges(12.5, 30.0, 10.0, 500.0, 5.0, "")) for kind in (Mit, Damiao, Robstride)
    )
    assert [drive.explain(k) for drive, k in ((mit, 4), (damiao, 9), (robstride, 1))] == ["under-voltage"] * 3
    assert robstride.explain(0b100010) == "over-current, not calibrated"
    assert damiao.explain(13) == "no command within its watchdog" and mit.explain(99) == "number 99"
