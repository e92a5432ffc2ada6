"""Bits on the wire, against a bit-by-bit count and the bound that nobody exceeds."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workbench.can import Frame, frame_bits, worst_bits
from workbench.can.flexible import seconds, worst_seconds
from workbench.can.frame import FD_LENGTHS

IDS = st.one_of(
    st.tuples(st.integers(0, 0x7FF), st.just(False)), st.tuples(st.integers(0, 0x1FFFFFFF), st.just(True))
)
FRAMES = st.one_of(
    st.builds(lambda id, data: Frame(id[0], data, id[1]), IDS, st.binary(max_size=8)),
    st.builds(lambda id: Frame(id[0], b"", id[1], remote=True), IDS),
)
FLEXIBLE = st.builds(
    lambda id, data: Frame(id[0], data, id[1], fd=True),
    IDS, st.sampled_from(FD_LENGTHS).flatmap(lambda n: st.binary(min_size=n, max_size=n)),
)  # fmt: skip


def counted(frame: Frame) -> int:
    """The same bits one by one, from the standard's description of a frame."""
    if frame.extended:
        asks = int(frame.remote)
        head = f"0{frame.id >> 18:011b}11{frame.id & 0x3FFFF:018b}{asks}00{len(frame.data):04b}"
    else:
        head = f"0{frame.id:011b}{int(frame.remote)}00{len(frame.data):04b}"
    bits = head + "".join(f"{byte:08b}" for byte in frame.data)
    crc = 0
    for bit in bits:
        flip = int(bit) ^ crc >> 14
        crc = crc << 1 & 0x7FFF
        crc ^= 0x4599 if flip else 0
    bits += f"{crc:015b}"
    sent, run = "", ""
    for bit in bits:
        sent, run = sent + bit, run + bit if run and run[-1] == bit else bit
        if len(run) == 5:
            run = "1" if bit == "0" else "0"
            sent += run
    return len(sent) + 13


@given(FRAMES)
def test_bits_are_those_counted_one_by_one(frame: Frame) -> None:
    assert frame_bits(frame) == counted(frame) <= worst_bits(len(frame.data), frame.extended)


def both_rates(frame: Frame) -> tuple[int, int]:
    """Bits at the slow and at the fast rate, one by one, as ISO 11898-1:2015 draws a frame of CAN-FD."""
    code = FD_LENGTHS.index(len(frame.data))
    if frame.extended:
        arbitrates = f"0{frame.id >> 18:011b}11{frame.id & 0x3FFFF:018b}0101"
    else:
        arbitrates = f"0{frame.id:011b}00101"
    stuffed, run = [0, 0], ""
    data = f"0{code:04b}" + "".join(f"{byte:08b}" for byte in frame.data)
    for part, bits in enumerate((arbitrates, data)):
        for bit in bits:
            run = run + bit if run and run[-1] == bit else bit
            if len(run) == 5:
                stuffed[part] += 1
                run = "1" if bit == "0" else "0"
    checksum = "c" * (4 + (17 if len(frame.data) <= 16 else 21))
    fixed = "".join(("s" if k % 4 == 0 else "") + bit for k, bit in enumerate(checksum))
    fixed += "s" if len(checksum) % 4 == 0 else ""
    slow, fast = len(arbitrates) + stuffed[0], len(data) + stuffed[1] + len(fixed) + len("d")
    return slow + len("adeeeeeeeiii"), fast


@given(FLEXIBLE)
def test_a_flexible_frame_takes_the_bits_of_both_its_rates(frame: Frame) -> None:
    slow, fast = both_rates(frame)
    assert seconds(frame, 1e6, 5e6) == pytest.approx(slow / 1e6 + fast / 5e6, rel=1e-12)
    worst = worst_seconds(len(frame.data), frame.extended, True, 1e6, 5e6)
    assert seconds(frame, 1e6, 5e6) <= worst * (1 + 1e-12)


@pytest.mark.parametrize("length", FD_LENGTHS)
def test_every_length_of_a_flexible_frame_takes_its_bits(length: int) -> None:
    for id, extended in ((0, False), (0x7FF, False), (0, True), (0x1FFFFFFF, True)):
        for byte in (b"\0", b"\xff", b"\x0f", b"\x83"):
            frame = Frame(id, byte * length, extended, fd=True)
            slow, fast = both_rates(frame)
            assert seconds(frame, 1e6, 5e6) == pytest.approx(slow / 1e6 + fast / 5e6, rel=1e-12)


@pytest.mark.parametrize(
    ("length", "extended", "slow", "fast"),
    [(8, False, 17 + 4 + 12, 5 + 64 + 17 + 28), (64, True, 36 + 8 + 12, 5 + 512 + 130 + 33)],
)
def test_the_longest_flexible_frames_by_hand(length: int, extended: bool, slow: int, fast: int) -> None:
    # slow: what arbitrates, its stuffing, what follows the checksum; fast: length and data, the checksum with
    # its own stuffing and delimiter, stuffing
    assert worst_seconds(length, extended, True, 1e6, 5e6) == pytest.approx(slow * 1e-6 + fast * 2e-7)


def test_the_worst_flexible_frame_can_be_reached() -> None:
    # zeros all along: the most stuffing that there is, but for the ones of FDF and BRS
    frame = Frame(0, bytes(64), False, fd=True)
    assert 0.9 < seconds(frame, 1e6, 1e6) / worst_seconds(64, False, True, 1e6, 1e6) <= 1.0


@given(FRAMES)
def test_classical_frames_know_one_rate(frame: Frame) -> None:
    assert seconds(frame, 5e5, 5e6) == frame_bits(frame) / 5e5


def test_the_worst_frame_is_as_long_as_published() -> None:
    assert worst_bits(8) == 135 and worst_bits(8, extended=True) == 160


@given(FRAMES, FRAMES)
def test_arbitration_is_won_by_the_first_dominant_bit(a: Frame, b: Frame) -> None:
    def identifier(frame: Frame) -> str:
        base = frame.id >> 18 if frame.extended else frame.id
        return f"{base:011b}" + (f"11{frame.id & 0x3FFFF:018b}" if frame.extended else "00")

    if identifier(a) != identifier(b):
        assert (a.priority < b.priority) == (identifier(a) < identifier(b))
