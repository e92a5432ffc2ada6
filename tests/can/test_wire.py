"""The bus between nodes: order, timing, errors, and what a node that is off does."""

from __future__ import annotations

import pytest

from workbench.can import Frame, Wire, frame_bits
from workbench.can.wire import QUEUE

A, B, C = Frame(0x10, b"\1" * 8), Frame(0x20, b"\2" * 8), Frame(0x30, b"\3" * 8)


class Listener:
    def __init__(self) -> None:
        self.got: list[tuple[float, Frame]] = []

    def __call__(self, stamp: float, frame: Frame) -> None:
        self.got.append((stamp, frame))


def test_the_lowest_identifier_goes_first_and_takes_its_bits() -> None:
    wire, ear, echo = Wire(1e6), Listener(), Listener()
    one, two, _ = (
        wire.attach("one", Listener(), echo),
        wire.attach("two", Listener()),
        wire.attach("ear", ear),
    )
    wire.send(one, C, 0.0)
    wire.send(one, A, 0.0)  # behind its own C: a queue is a queue
    wire.send(two, B, 0.0)
    wire.advance(1.0)
    assert [frame for _, frame in ear.got] == [B, C, A]
    ends = [stamp for stamp, _ in ear.got]
    assert ends[0] == pytest.approx(frame_bits(B) * 1e-6)
    assert ends[2] - ends[1] == pytest.approx(frame_bits(A) * 1e-6)
    assert [frame for _, frame in echo.got] == [C, A], "its own frames come back as echoes"


def test_a_frame_under_way_is_not_overtaken() -> None:
    wire, ear = Wire(1e6), Listener()
    one, two, _ = wire.attach("one", Listener()), wire.attach("two", Listener()), wire.attach("ear", ear)
    wire.send(one, C, 0.0)
    wire.advance(50e-6)
    wire.send(two, A, 50e-6)
    assert wire.next_done() == pytest.approx(frame_bits(C) * 1e-6)
    wire.advance(1.0)
    assert [frame for _, frame in ear.got] == [C, A] and wire.next_done() is None


def test_what_is_sent_later_starts_later() -> None:
    wire, ear = Wire(5e5), Listener()
    one, _ = wire.attach("one", Listener()), wire.attach("ear", ear)
    wire.send(one, A, 0.25)
    wire.advance(0.2)
    assert not ear.got
    wire.advance(1.0)
    assert ear.got[0][0] == pytest.approx(0.25 + frame_bits(A) / 5e5)


def test_a_damaged_frame_is_sent_again() -> None:
    hits = iter([True, True, False])
    wire, ear = Wire(1e6, damaged=lambda node, frame: next(hits)), Listener()
    one, _ = wire.attach("one", Listener()), wire.attach("ear", ear)
    wire.send(one, A, 0.0)
    wire.advance(1.0)
    assert len(ear.got) == 1 and one.errors == 15
    assert ear.got[0][0] > 2e-6 * frame_bits(A)


def test_a_node_whose_frames_are_always_hit_goes_off_after_32() -> None:
    wire, ear = Wire(1e6, damaged=lambda node, frame: node.name == "one"), Listener()
    one, two, _ = wire.attach("one", Listener()), wire.attach("two", Listener()), wire.attach("ear", ear)
    for frame in (A, B):
        wire.send(one, frame, 0.0)
    wire.send(two, C, 0.0)
    wire.advance(1e-3)
    assert one.errors > 0
    wire.advance(1.0)
    assert one.off and one.state == "off" and not one.queue and [frame for _, frame in ear.got] == [C]
    assert not wire.send(one, A, 1.0)
    one.come_back()
    wire.damaged = None
    assert wire.send(one, A, 1.0)
    wire.advance(2.0)
    assert ear.got[-1][1] == A, "and nothing of before"


def test_a_full_queue_takes_no_more() -> None:
    wire = Wire(1e6)
    one = wire.attach("one", Listener())
    assert [wire.send(one, A, 0.0) for _ in range(QUEUE + 1)] == [True] * QUEUE + [False]


def test_a_node_alone_is_not_acknowledged_and_stays_passive() -> None:
    wire = Wire(1e6)
    one = wire.attach("one", Listener())
    wire.send(one, A, 0.0)
    wire.advance(0.1)
    assert one.state == "passive" and len(one.queue) == 1
    ear = Listener()
    wire.attach("ear", ear)
    wire.advance(0.2)
    assert len(ear.got) == 1


def test_a_receiver_may_miss_a_frame() -> None:
    wire, deaf, ear = Wire(1e6, lost=lambda node, frame: node.name == "deaf"), Listener(), Listener()
    one, _, _ = wire.attach("one", Listener()), wire.attach("deaf", deaf), wire.attach("ear", ear)
    wire.send(one, A, 0.0)
    wire.advance(1.0)
    assert ear.got and not deaf.got
