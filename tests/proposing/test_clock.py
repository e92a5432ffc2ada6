"""Rows of other topics, stamps in two columns, counters that begin anew, several runs in one file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.proposing.make import KP, columns, imported, log, same, text
from workbench.core import InputError
from workbench.proposing import Answers, open_table, propose

LOG = log()
N = len(LOG.t)


def put(folder: Path, content: str) -> Path:
    path = folder / "run.csv"
    path.write_text(content)
    return path


def with_rows_between(data: dict[str, np.ndarray], others: np.ndarray, name: str) -> dict[str, np.ndarray]:
    """The columns with rows of another topic at the times `others`, in order of time."""
    t = np.concatenate([data["t"], others])
    order = np.argsort(t, kind="stable")
    nan = np.full(len(others), np.nan)
    out = {n: np.concatenate([v, nan])[order] for n, v in data.items() if n != "t"}
    value = np.concatenate([np.full(len(data["t"]), np.nan), np.cos(others)])[order]
    return {"t": t[order], **out, name: value}


@pytest.mark.parametrize("rate", [3.0, 60.0, 900.0])
@pytest.mark.parametrize("name", ["imu/angular_velocity/x", "battery voltage", "arm/shoulder/position"])
def test_rows_of_another_topic_are_no_rows(tmp_path: Path, rate: float, name: str) -> None:
    others = np.arange(0.0013, LOG.t[-1], 1 / rate)
    data = with_rows_between(columns(LOG), others, name)
    twice = np.insert(np.arange(len(data["t"])), [40, 90], [40, 90])  # logged twice,
    twice[[300, 310]] = twice[[310, 300]]  # and two rows exchanged
    answers = Answers(model_axes=("hip", "knee"))
    proposal, recording = imported(put(tmp_path, text({n: v[twice] for n, v in data.items()})), answers)
    same(recording, LOG, tolerance=1e-9)
    assert len(recording) == N and recording.period == pytest.approx(0.005) and recording.valid.all()
    assert recording.controller.period_s == pytest.approx(0.005)
    assert np.allclose(recording.controller.kp, KP, rtol=0.01)
    assert any("rows without a number of any axis" in note for note in proposal.notes)


def test_a_reference_on_rows_of_its_own_is_held_on_the_axes(tmp_path: Path) -> None:
    plain = columns(LOG)
    seen = {n: v for n, v in plain.items() if "ref" not in n}
    at = LOG.t[::4] - 0.001  # asked for at a quarter of the rate, before the row that shows it
    data = with_rows_between(seen, at, "other")
    for i, joint in enumerate(("hip", "knee")):
        cells = np.full(len(data["t"]), np.nan)
        cells[np.isfinite(data["other"])] = LOG.ref[::4, i]
        data[f"pos_ref_{joint}"] = cells
    del data["other"]
    _, recording = imported(put(tmp_path, text(data)))
    assert len(recording) == N and recording.period == pytest.approx(0.005)
    assert np.abs(recording.signals["position_reference"] - np.repeat(LOG.ref[::4], 4, axis=0)).max() < 1e-9


@pytest.mark.parametrize(
    ("names", "digits"),
    [
        (("header.stamp.sec", "header.stamp.nanosec"), 9),
        (("stamp.secs", "stamp.nsecs"), 9),
        (("tv_sec", "tv_usec"), 6),
        (None, 9),
        (None, 3),
    ],
)
def test_stamps_in_two_columns_are_joined(tmp_path: Path, names: tuple[str, str] | None, digits: int) -> None:
    ticks = np.round((LOG.t + 0.3) * 10**digits).astype(np.int64)
    pair = {"a": 1_700_000_000 + ticks // 10**digits, "b": ticks % 10**digits}
    if names:
        pair = dict(zip(names, pair.values(), strict=True))
        data = {**pair, **{n: v for n, v in columns(LOG).items() if n != "t"}}
    else:
        data = {**pair, **{f"q{i}": LOG.q[:, i] for i in (0, 1)}, **{f"v{i}": LOG.v[:, i] for i in (0, 1)}}
    _, recording = imported(put(tmp_path, text(data, header=names is not None)))
    assert len(recording) == N and recording.period == pytest.approx(0.005, rel=1e-6)
    assert np.abs(recording.position - LOG.q).max() < 1e-9


@pytest.mark.parametrize(("name", "period", "tick"), [("nanosec", 1e9, 1e-9), ("t_us", 2**32, 1e-6)])
def test_a_counter_that_begins_anew_goes_on(tmp_path: Path, name: str, period: float, tick: float) -> None:
    data = columns(LOG)
    ticks = (np.round(LOG.t / tick) + period - 3e6) % period
    proposal, recording = imported(
        put(tmp_path, text({name: ticks, **{n: v for n, v in data.items() if n != "t"}}))
    )
    same(recording, LOG, tolerance=1e-9)
    assert any("restarts" in note for note in proposal.notes)


def test_most_of_a_log_is_not_left_out_without_a_question(tmp_path: Path) -> None:
    runs = [slice(0, 300), slice(0, 400), slice(0, 350)]
    data = {n: np.concatenate([v[run] for run in runs]) for n, v in columns(LOG).items()}
    table = open_table(put(tmp_path, text(data)))
    asked = propose(table).questions
    assert [q.key for q in asked] == ["episode"] and asked[0].best == "1"
    assert "300, 400, 350" in asked[0].text and asked[0].option == "--episode 1"
    _, recording = imported(table.file, Answers(episode=2))
    assert len(recording) == 350
    assert np.abs(recording.position - LOG.q[:350]).max() < 1e-9
    with pytest.raises(InputError, match="has no run 3"):
        propose(table, Answers(episode=3))


def test_rows_of_which_most_have_one_stamp_are_refused(tmp_path: Path) -> None:
    data = columns(LOG)
    data["t"] = np.repeat(np.cumsum(np.random.default_rng(1).uniform(0.005, 0.1, N // 4)), 4)
    with pytest.raises(InputError, match=f"only {N // 4} of {N} rows can be used"):
        propose(open_table(put(tmp_path, text(data))))


def two_drivers(file: Path, other_joints: tuple[str, ...], more: int) -> Path:
    """A log of ROS in which two drivers publish joint states on one topic; the other has `more` rows."""
    writer_of = pytest.importorskip("mcap.writer")
    with file.open("wb") as out:
        writer = writer_of.Writer(out)
        writer.start()
        channel = writer.register_channel(
            "/joint_states", "json", writer.register_schema("state", "jsonschema", b"{}")
        )

        def publish(stamp: float, joints: tuple[str, ...], q: list[float], v: list[float]) -> None:
            text = json.dumps({"name": joints, "position": q, "velocity": v}).encode()
            writer.add_message(channel, round(stamp * 1e9), text, round(stamp * 1e9))

        for k, t in enumerate(LOG.t):
            publish(t, ("hip", "knee"), LOG.q[k].tolist(), LOG.v[k].tolist())
            for j in range(1 + (k < more)):
                publish(t + 0.0007 + 0.001 * j, other_joints, [0.1 * t, 0.2], [0.1, 0.0])
        writer.finish()
    return file


@pytest.mark.parametrize("more", [0, 50])
def test_two_drivers_on_one_topic_are_two_series(tmp_path: Path, more: int) -> None:
    file = two_drivers(tmp_path / "run.mcap", ("shoulder", "elbow"), more)
    assert len(open_table(file)) == N + more, "rows of one stand beside those of the other"
    _, recording = imported(file, Answers(model_axes=("hip", "knee")))
    assert len(recording) == N and recording.period == pytest.approx(0.005)
    assert np.abs(recording.position - LOG.q).max() < 1e-9
    assert np.abs(recording.velocity - LOG.v).max() < 1e-9


@pytest.mark.parametrize("late", [0.002, 0.1, 0.6])
def test_what_a_loop_asked_for_belongs_to_the_row_it_answers(tmp_path: Path, late: float) -> None:
    """A command is published a little after the row that it was made of; it is not the next row's."""
    plain = columns(LOG)
    seen = {n: v for n, v in plain.items() if "ref" not in n and "cmd" not in n}
    data = with_rows_between(seen, LOG.t + late * 0.005, "other")
    published = np.isfinite(data.pop("other"))
    for name in plain.keys() - seen.keys():
        data[name] = np.full(len(data["t"]), np.nan)
        data[name][published] = plain[name]
    _, recording = imported(put(tmp_path, text(data)))
    same(recording, LOG, tolerance=1e-9)
    assert np.allclose(recording.controller.kp, KP, rtol=1e-6)


def test_a_drive_with_rows_of_its_own_keeps_its_law(tmp_path: Path) -> None:
    plain = columns(LOG)
    own = {n: v for n, v in plain.items() if "knee" not in n}
    late = {n: v for n, v in plain.items() if "knee" in n}
    data = with_rows_between(own, LOG.t + 0.0017, "other")
    at = np.isfinite(data.pop("other"))
    for name, values in late.items():
        data[name] = np.full(len(data["t"]), np.nan)
        data[name][at] = values
    proposal, recording = imported(put(tmp_path, text(data)))
    assert recording.period == pytest.approx(0.005)
    assert np.allclose(recording.controller.kp, KP, rtol=1e-6)
    command, measured = (recording.signals[f"torque_{s}"][:, 1] for s in ("command", "measured"))
    assert np.std(measured - command) < 0.03  # the noise alone: one clock for both
    assert not any("without a number of any axis" in note for note in proposal.notes)


@pytest.mark.parametrize("count", [2, 5])
def test_rows_that_stand_there_twice_are_taken_once_and_said(tmp_path: Path, count: int) -> None:
    """A logger at 1 kHz of sensors at 200 Hz: half and more of the rows held nothing new, in silence."""
    data = {name: np.repeat(values, count) for name, values in columns(LOG).items()}
    data["t"] = LOG.t[0] + np.arange(count * N) * (LOG.t[1] - LOG.t[0]) / count
    proposal, recording = imported(put(tmp_path, text(data)), Answers(model_axes=("hip", "knee")))
    often = "twice" if count == 2 else f"{count} times"
    assert f"Every row is repeated {often}" in " ".join(proposal.notes)
    assert len(recording) == N and recording.period == pytest.approx(LOG.t[1] - LOG.t[0])
    np.testing.assert_allclose(recording.position, LOG.q, atol=1e-6)


def test_rows_that_are_no_copies_stay(tmp_path: Path) -> None:
    """One signal of its own in every row; and an encoder that turns slowly, whose steps come as it turns."""
    twice = {name: np.repeat(values, 2) for name, values in columns(LOG).items()}
    twice["t"] = np.arange(2 * N) * 0.5 * (LOG.t[1] - LOG.t[0])
    own = next(name for name in twice if name != "t")
    noisy = twice | {own: twice[own] + 1e-4 * np.random.default_rng(0).standard_normal(2 * N)}
    slow = {"t": LOG.t, "pos_a": np.round(LOG.q[:, 0] * 60) / 60, "pos_b": np.round(LOG.q[:, 1] * 60) / 60}
    for data in (noisy, slow):
        proposal = propose(open_table(put(tmp_path, text(data))))
        assert not any("is repeated" in note for note in proposal.notes)
