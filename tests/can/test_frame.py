"""Bits on the wire, against a bit-by-bit count and the bound that nobody exceeds."""

from hypothesis import given
from hypothesis import strategies as st

from workbench.can import Frame, frame_bits, worst_bits

FRAMES = st.one_of(
    st.builds(Frame, st.integers(0, 0x7FF), st.binary(max_size=8)),
    st.builds(Frame, st.integers(0, 0x1FFFFFFF), st.binary(max_size=8), st.just(True)),
)


def counted(frame: Frame) -> int:
    """The same bits one by one, from the standard's description of a frame."""
    if frame.extended:
        head = f"0{frame.id >> 18:011b}11{frame.id & 0x3FFFF:018b}000{len(frame.data):04b}"
    else:
        head = f"0{frame.id:011b}000{len(frame.data):04b}"
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


def test_the_worst_frame_is_as_long_as_published() -> None:
    assert worst_bits(8) == 135 and worst_bits(8, extended=True) == 160


@given(FRAMES, FRAMES)
def test_arbitration_is_won_by_the_first_dominant_bit(a: Frame, b: Frame) -> None:
    def identifier(frame: Frame) -> str:
        base = frame.id >> 18 if frame.extended else frame.id
        return f"{base:011b}" + (f"11{frame.id & 0x3FFFF:018b}" if frame.extended else "00")

    if identifier(a) != identifier(b):
        assert (a.priority < b.priority) == (identifier(a) < identifier(b))
