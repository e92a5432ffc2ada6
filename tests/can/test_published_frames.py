"""Frames as the manuals have them, byte for byte; frames of others, and numbers that no frame holds."""

from __future__ import annotations

import math

import pytest

from tests.can.test_codecs import AK, DM4310, DRIVES, EVERY
from workbench.can import Damiao, Feedback, Frame, FrameError, Mit, Parameter, Robstride, Setpoint


@pytest.mark.parametrize(
    ("drive", "actions", "id"),
    [
        # firmware's own numbers: enter, exit, zero; clear is Damiao's
        (DRIVES["mit"], {"enable": 0xFC, "disable": 0xFD, "zero": 0xFE}, 3),
        (DRIVES["damiao"], {"enable": 0xFC, "disable": 0xFD, "zero": 0xFE, "clear": 0xFB}, 1),
    ],
)
def test_actions_as_published(drive, actions, id) -> None:
    for action, byte in actions.items():
        assert drive.act(action) == Frame(id, b"\xff" * 7 + bytes([byte]))


def test_robstride_frames_as_published() -> None:
    drive = DRIVES["robstride"]
    head = 0xFD << 8 | 0x7F
    acts = {"enable": (3, 0), "disable": (4, 0), "clear": (4, 1), "zero": (6, 1)}
    for action, (kind, first) in acts.items():
        assert drive.act(action) == Frame(kind << 24 | head, bytes([first]) + b"\0" * 7, True)
    assert drive.read("mode") == Frame(17 << 24 | head, bytes.fromhex("0570000000000000"), True)
    # run mode 0 is the one in which it follows setpoints
    assert drive.write(Parameter("mode", 1.0)).data == bytes.fromhex("0570000000000000")
    assert drive.write(Parameter("mode", 3.0)).data == bytes.fromhex("0570000002000000")
    said = drive.decode(Frame(17 << 24 | 0x7F << 8 | 0xFD, bytes.fromhex("2870000010270000"), True))
    assert said == Parameter("watchdog", pytest.approx(0.5))
    said = drive.decode(Frame(17 << 24 | 0x7F << 8 | 0xFD, bytes.fromhex("0570000002000000"), True))
    assert said == Parameter("mode", 3.0), "not the one that follows setpoints"
    full = bytes.fromhex("fffe8000000001f4")  # position, velocity, torque, tenths of a degree
    got = drive.decode(Frame(2 << 24 | (2 << 14 | 0x7F) << 8 | 0xFD, full, True))
    assert isinstance(got, Feedback) and got.enabled and got.temperature == pytest.approx(50.0)
    assert got.position == pytest.approx(4 * math.pi, abs=4e-4) and got.torque == pytest.approx(-12.0)
    command = drive.command(Setpoint(4 * math.pi, -30.0, 500.0, 0.0, -12.0))
    assert command == Frame(1 << 24 | 0x7F, bytes.fromhex("ffff0000ffff0000"), True)
    assert drive.extended and command.extended, "which counts for the load of its bus"
    for kind in {*range(32)} - {2, 17, 21}:
        assert drive.decode(Frame(kind << 24 | 0x7F << 8 | 0xFD, bytes(8), True)) is None
    for kind in {*range(32)} - {1, 3, 4, 6}:  # no parameter is called 0
        assert drive.asked(Frame(kind << 24 | head, bytes(8), True)) is None


def test_damiao_registers_as_published() -> None:
    drive = DRIVES["damiao"]
    numbers = {"watchdog": 9, "mode": 10, "position": 21, "velocity": 22, "torque": 23}
    for name, number in numbers.items():
        assert drive.read(name).data == bytes([1, 0, 0x33, number, 0, 0, 0, 0])
        said = drive.decode(drive.tell(Parameter(name, 1.0)))
        assert said == Parameter(name, pytest.approx(1.0))
    assert drive.write(Parameter("mode", 1.0)).data == bytes.fromhex("0100550a01000000")
    assert drive.write(Parameter("torque", 10.0)).data == bytes.fromhex("0100551700002041")
    # drive 1 is on, 57 and 61 degrees; what it says of itself when it is off has status 0
    got = drive.decode(Frame(0x11, bytes.fromhex("11ffff00000f393d")))
    assert got == Feedback(*map(pytest.approx, (12.5, -30.0, -10.0 + 15 * 20 / 4095, 61.0)), True, 0)
    board = drive.decode(Frame(0x11, bytes.fromhex("1180008008003d39")))
    assert isinstance(board, Feedback) and board.temperature == 61.0, "whichever is hotter"
    off = drive.decode(Frame(0x11, bytes.fromhex("0180008008003939")))
    assert isinstance(off, Feedback) and off.enabled is False and off.fault == 0


def others(frame: Frame) -> list[Frame]:
    """The same bytes to or of somebody else."""
    flipped = Frame(frame.id & 0x7FF, frame.data, not frame.extended)
    return [flipped, *(Frame(frame.id ^ 1 << bit, frame.data, frame.extended) for bit in range(8))]


@EVERY
def test_frames_of_others_are_left_to_them(drive) -> None:
    said = drive.answer(Feedback(1.0, -2.0, 3.0, 40.0, True))
    assert all(drive.decode(frame) is None for frame in others(said))
    asks = [drive.command(Setpoint(0.1, 0.0, 1.0, 1.0, 0.0)), drive.act("enable")]
    for frame in asks:
        assert all(drive.asked(other) is None for other in others(frame))
        for data in (frame.data[:7], frame.data[:6], b""):
            assert drive.asked(Frame(frame.id, data, frame.extended)) is None


def test_drives_that_share_an_answer_id_are_told_by_a_byte() -> None:
    one, two = Mit(3, 0, AK), Mit(4, 0, AK)
    assert two.decode(one.answer(Feedback(1.0, 0.0, 0.0))) is None
    said = DRIVES["damiao"].answer(Feedback(1.0, 0.0, 0.0, 30.0, True))
    register = Damiao(2, 0x11, DM4310).tell(Parameter("watchdog", 0.02))
    assert Damiao(2, 0x11, DM4310).decode(said) is None
    for ask in (DRIVES["damiao"].read("watchdog"), DRIVES["damiao"].write(Parameter("mode", 1.0))):
        assert Damiao(2, 0x11, DM4310).asked(ask) is None, "the registers of all are asked for on one id"
    unknown = Frame(0x7FF, bytes([1, 0, 0x33, 99, 0, 0, 0, 0]))
    assert DRIVES["damiao"].asked(unknown) is None
    assert not isinstance(DRIVES["damiao"].decode(register), Parameter)


@pytest.mark.parametrize(
    ("kind", "id", "reply"),
    [
        (Mit, 3, 3), (Mit, -1, 0), (Mit, 0x100, 0), (Mit, 3, 0x800), (Mit, 3, -1),
        (Damiao, 0x10, 0x11), (Damiao, 1, 1), (Damiao, 1, 0x7FF),
        (Robstride, 0x100, 0xFD), (Robstride, 1, 0x100), (Robstride, 7, 7), (Robstride, -1, 0xFD),
    ],
)  # fmt: skip
def test_ids_that_could_be_mistaken_are_refused(kind, id: int, reply: int) -> None:
    with pytest.raises(FrameError):
        kind(id, reply, AK)


@pytest.mark.parametrize(
    ("kind", "id", "reply"),
    [
        (Mit, 0, 0x7FF),
        (Mit, 0xFF, 0),
        (Damiao, 0, 1),
        (Damiao, 0xF, 0x7FE),
        (Robstride, 0xFF, 0),
        (Robstride, 0, 0xFF),
    ],
)
def test_every_other_id_is_one(kind, id: int, reply: int) -> None:
    drive = kind(id, reply, AK)
    got = drive.decode(drive.answer(Feedback(1.0, 0.0, 0.0, 20.0, True)))
    assert isinstance(got, Feedback) and got.position == pytest.approx(1.0, abs=2e-4)
    assert drive.asked(drive.act("enable")) == "enable"


def test_mit_drives_can_be_asked_for_nothing() -> None:
    drive = DRIVES["mit"]
    asks = (lambda: drive.read("watchdog"), lambda: drive.write(Parameter("watchdog", 0.02)))
    for ask in (*asks, lambda: drive.tell(Parameter("watchdog", 0.02))):
        with pytest.raises(FrameError, match="mit drives cannot be"):
            ask()
    with pytest.raises(FrameError, match="do not report their torque"):
        DRIVES["robstride"].read("torque")


@pytest.mark.parametrize("drive", [DRIVES["damiao"], DRIVES["robstride"]], ids=["damiao", "robstride"])
@pytest.mark.parametrize("value", [-1.0, 1e9, math.inf])
def test_a_register_takes_no_number_that_it_cannot_hold(drive, value: float) -> None:
    for name in ("watchdog", "mode"):
        with pytest.raises(FrameError, match="cannot be sent"):
            drive.write(Parameter(name, value * 20))


@EVERY
def test_what_a_drive_says_beyond_its_ranges_are_their_ends(drive) -> None:
    r, over = drive.ranges, 1.01
    for sign in (1.0, -1.0):
        far = Feedback(sign * over * r.position, sign * over * r.velocity, sign * over * r.torque, 1e4 * sign)
        got = drive.decode(drive.answer(far._replace(enabled=True)))
        assert isinstance(got, Feedback)
        assert got[:3] == pytest.approx((sign * r.position, sign * r.velocity, sign * r.torque))
        least, most = {"mit": (-40.0, 215.0), "damiao": (0.0, 255.0), "robstride": (0.0, 6553.5)}[drive.name]
        assert got.temperature == (most if sign > 0 else least)


def test_every_fault_has_the_name_that_the_manual_gives_it() -> None:
    cubemars = (
        "hot motor",
        "over-current",
        "over-voltage",
        "under-voltage",
        "encoder",
        "hot MOSFET",
        "stalled motor",
    )
    assert [DRIVES["mit"].explain(k) for k in range(1, 8)] == list(cubemars)
    damiao = ("over-voltage", "under-voltage", "over-current", "hot MOSFET", "hot rotor")
    assert [DRIVES["damiao"].explain(k) for k in (*range(8, 13), 14)] == [*damiao, "overload"]
    robstride = (
        "under-voltage",
        "over-current",
        "hot motor",
        "magnetic encoder",
        "Hall encoder",
        "not calibrated",
    )
    assert [DRIVES["robstride"].explain(1 << k) for k in range(6)] == list(robstride)
    for k, _ in enumerate(robstride):  # bits 16 to 21 of the identifier
        said = Frame((2 << 24) | (2 << 14 | 1 << (8 + k) | 0x7F) << 8 | 0xFD, bytes(8), True)
        got = DRIVES["robstride"].decode(said)
        assert isinstance(got, Feedback) and got.fault == 1 << k
    assert DRIVES["robstride"].decode(Frame(21 << 24 | 0x7F << 8 | 0xFD, bytes(8), True)) is None
