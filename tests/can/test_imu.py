"""The inertial unit on a bus: exact to its steps, deaf to everything else, and readable with the DBC."""

from __future__ import annotations

import cantools.database
import numpy as np
import pytest

from tests.can.make import config, motor
from workbench.can import Frame, FrameError, dbc
from workbench.can.imu import WorkbenchImu
from workbench.deployment.base import BaseFeedback

UNIT, UP = WorkbenchImu(0x60), (0.0, 0.0, 1.0)


def test_what_is_sent_is_what_is_read_and_what_a_dbc_reads() -> None:
    generator, database = np.random.default_rng(3), cantools.database.load_string(dbc({}, UNIT))
    for _ in range(200):
        angular, down = generator.uniform(-34, 34, 3), generator.standard_normal(3)
        force = generator.uniform(-15, 15, 3)
        down /= np.linalg.norm(down)
        for frame, (name, wanted, step) in zip(
            UNIT.encode(tuple(angular), tuple(down), tuple(force)),
            (("angular", angular, 70 / 65535), ("gravity", down, 2.4 / 65535), ("force", force, 32 / 65535)),
            strict=True,
        ):
            quantity, values = UNIT.decode(frame) or ("", ())
            assert quantity == name and np.abs(values - wanted).max() <= 0.5001 * step
            read = database.decode_message(frame.id, frame.data)
            assert isinstance(read, dict)
            assert [read[f"{name}_{axis}"] for axis in "xyz"] == pytest.approx(values, abs=1e-9)


def test_what_is_beyond_its_range_stays_at_the_end_of_it() -> None:
    frame, *_ = UNIT.encode((1e3, -1e3, 0.0), (0.0, 0.0, -1.0), UP)
    said = UNIT.decode(frame)
    assert said and said[1][:2] == pytest.approx((35.0, -35.0))


def test_frames_that_do_not_fit_change_nothing(tmp_path) -> None:
    loaded = config(tmp_path, [motor("hip", 1)], imu={"bus": "can0", "id": 0x60})
    base, generator = BaseFeedback(loaded, 0.009), np.random.default_rng(5)
    for frame in UNIT.encode((0.1, 0.2, 0.3), (0.0, 0.0, -1.0), UP):
        assert base.take(frame, 1.0, 1.001) == "base"
    before, age = base.motion, base.age(1.002)
    for _ in range(20_000):
        id, length = int(generator.integers(0x800)), int(generator.integers(9))
        frame = Frame(id, generator.bytes(length))
        if id in UNIT.ids and length == 6 and id in (0x60, 0x62):
            continue  # any six bytes are an angular velocity, or a force
        assert base.take(frame, 1.0, 1.001) in (None, "garbage", "old")
    for frame in UNIT.encode((9.0, 9.0, 9.0), (1.0, 0.0, 0.0), UP):
        assert base.take(frame, 1.0, 1.001) == "old", "repeated"
        assert base.take(frame, 1.02, 1.03) == "old", "too long on its way"
    assert base.motion is before and base.age(1.002) == age
    with pytest.raises(FrameError):
        UNIT.decode(Frame(0x61, bytes(6)))
    assert UNIT.decode(Frame(0x60, bytes(6), extended=True)) is None


def test_what_is_unknown_is_old_and_what_is_absent_not_missed(tmp_path) -> None:
    loaded = config(tmp_path, [motor("hip", 1)], imu={"bus": "can0", "id": 0x60})
    assert BaseFeedback(loaded, 0.009).age(5.0) == float("inf")
    assert BaseFeedback(loaded.model_copy(update={"imu": None}), 0.009).age(5.0) == 0.0


def test_what_carries_a_base_is_averaged_over_a_fall(tmp_path) -> None:
    loaded = config(tmp_path, [motor("hip", 1)], imu={"bus": "can0", "id": 0x60, "fall_s": 0.1})
    base, now = BaseFeedback(loaded, 0.009), 5.0

    def sample(force: float, sideways: float = 0.0) -> float:
        nonlocal now
        now += 0.002
        for frame in UNIT.encode((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), (sideways, 0.0, force)):
            base.take(frame, now, now)
        return base.carried

    early = [sample(1.0) for _ in range(46)]
    assert np.isnan(early).all(), "not before nine tenths of the time are known"
    assert [sample(1.0) for _ in range(50)] == pytest.approx([1.0] * 50, abs=1e-3)
    falls = [sample(0.0) for _ in range(50)]
    assert np.all(np.diff(falls) < 0.0) and falls[24] == pytest.approx(0.5, abs=0.02) and falls[-1] < 0.03
    for k in range(60):  # legs that swing pull to and fro, and carry nothing
        pulled = sample(0.0, 0.9 * (-1) ** k)
    assert pulled < 0.05
    for k in range(60):  # steps: nothing for a while, then twice the weight
        stepping = sample(2.0 if k % 20 < 10 else 0.0)
    assert 0.7 < stepping < 1.3
    still = config(tmp_path, [motor("hip", 1)])
    assert np.isnan(BaseFeedback(still, 0.009).carried)
