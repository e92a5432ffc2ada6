"""What a good recording becomes: SI, a uniform clock from 0, masks and notes."""

from __future__ import annotations

import gzip
from pathlib import Path
from time import process_time

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.io import savemat

from tests.data_helpers import (
    csv_text,
    data_folder,
    description,
    emps_toml,
    leg_examples,
    two_axes,
    write_recording,
    write_toml,
)
from workbench.recordings import load_recording, load_recordings


def with_columns(**more: object) -> dict[str, object]:
    return {**description()["columns"], **more}


def test_signals_arrive_in_the_order_of_the_axes(tmp_path: Path) -> None:
    r = load_recording(write_recording(tmp_path))
    data = two_axes()
    assert r.name == "made" and r.axes == ("a", "b") and r.units == ("rad", "rad")
    assert r.controller.kind == "unknown"
    np.testing.assert_array_equal(r.position, np.column_stack([data["q_a"], data["q_b"]]))
    np.testing.assert_allclose(r.time, data["t"], atol=1e-12)
    assert r.notes == () and r.derived == () and r.valid is not None and r.valid.all()


def test_units_scale_and_offset(tmp_path: Path) -> None:
    volts = {"column": "tau_b", "scale": 35.15, "offset": 2.0}
    r = load_recording(
        write_recording(
            tmp_path,
            columns=with_columns(torque_measured=["tau_a", volts], temperature=["q_a", "q_b"]),
            units={
                "position": ["deg", "mm"],
                "velocity": ["rpm", "mm/s"],
                "torque": ["mN*m", "kN"],
                "temperature": "degC",
            },
        )
    )
    data = two_axes()
    assert r.units == ("rad", "m")
    np.testing.assert_allclose(r.position[:, 0], np.deg2rad(data["q_a"]))
    np.testing.assert_allclose(r.position[:, 1], 1e-3 * data["q_b"])
    np.testing.assert_allclose(r.velocity[:, 0], data["w_a"] * 2 * np.pi / 60)
    np.testing.assert_allclose(r.signals["torque_measured"][:, 0], 1e-3 * data["tau_a"])
    np.testing.assert_allclose(r.signals["torque_measured"][:, 1], 1e3 * (35.15 * data["tau_b"] + 2.0))
    np.testing.assert_allclose(r.signals["temperature"][:, 0], data["q_a"] + 273.15)


def test_milliseconds(tmp_path: Path) -> None:
    data = two_axes()
    r = load_recording(write_recording(tmp_path, {**data, "t": 1e3 * data["t"]}, units={"time": "ms"}))
    assert r.period == pytest.approx(0.005, rel=1e-12)


def test_controller_excitation_and_timing(tmp_path: Path) -> None:
    r = load_recording(
        write_recording(
            tmp_path,
            controller={"kind": "pd", "coordinates": "joint", "kp": [50, 40.0], "period_s": 0.01},
            excitation={"kind": "multisine", "mode": "sum", "period_s": 1.0, "lines": "odd"},
            timing={"initial_at_rest": False, "delay": "loop"},
            coordinates="joint",
        )
    )
    assert r.controller.kp == (50.0, 40.0) and r.controller.kd == (0.0, 0.0)
    assert r.controller.coordinates == "joint" and r.coordinates == "joint"
    assert r.excitation.mode == "sum" and r.excitation.lines == "odd"
    assert not r.timing.initial_at_rest and r.timing.delay == "loop" and r.timing.feedforward_held


def test_scalars_stand_for_lists_of_one(tmp_path: Path) -> None:
    r = load_recording(
        write_recording(
            tmp_path,
            axes="a",
            columns={"time": "t", "position": "q_a"},
            controller={"kind": "pd", "kp": 3.0, "kd": 1},
        )
    )
    assert r.axes == ("a",) and r.controller.kp == (3.0,) and r.controller.kd == (1.0,)


def test_padded_header_mark_crlf_integers_and_other_columns(tmp_path: Path) -> None:
    data = two_axes() | {"text": ["x"] * 400, "q_a": np.arange(400) % 7}
    path = write_recording(tmp_path)
    text = csv_text(data, "\r\n").replace("t,q_a", " t , q_a ", 1)
    (tmp_path / "table.csv").write_bytes(b"\xef\xbb\xbf" + text.encode())
    np.testing.assert_array_equal(load_recording(path).position[:, 0], data["q_a"])


def test_semicolons_and_empty_lines_at_the_end(tmp_path: Path) -> None:
    path = write_recording(tmp_path)
    (tmp_path / "table.csv").write_text(csv_text(two_axes()).replace(",", ";") + "\n\n")
    assert len(load_recording(path)) == 400


@pytest.mark.parametrize("ending", ["csv.gz", "parquet", "mat"])
def test_every_format_gives_the_same(tmp_path: Path, ending: str) -> None:
    data = two_axes()
    expected = load_recording(write_recording(tmp_path))
    if ending == "csv.gz":
        (tmp_path / "table.csv.gz").write_bytes(gzip.compress(csv_text(data).encode()))
    elif ending == "parquet":
        pd.DataFrame(data).to_parquet(tmp_path / "table.parquet")
    else:
        savemat(tmp_path / "table.mat", data)
    r = load_recording(write_toml(tmp_path / "other.toml", description(table=f"table.{ending}")))
    assert r.signals.keys() == expected.signals.keys()
    for name, values in expected.signals.items():
        np.testing.assert_array_equal(r.signals[name], values)


def test_matlab_structs_and_channels(tmp_path: Path) -> None:
    data = two_axes()
    wide = np.vstack([data["q_a"], data["q_b"]])
    savemat(tmp_path / "t.mat", {"rec": {"t": data["t"][None, :], "q": wide}, "w": wide.T})
    columns = {"time": "rec.t", "position": ["rec.q[1]", "rec.q[0]"], "velocity": ["w[0]", "w[1]"]}
    r = load_recording(write_toml(tmp_path / "x.toml", description(table="t.mat", columns=columns)))
    np.testing.assert_array_equal(r.position, wide[::-1].T)
    np.testing.assert_array_equal(r.velocity, wide.T)


def test_masked_gap_is_filled_and_marked(tmp_path: Path) -> None:
    data = {k: v.copy() for k, v in two_axes().items()}
    valid = np.ones(400)
    valid[100:110] = 0
    for name in ("q_a", "tau_b"):
        data[name][100:110] = np.nan
    columns = with_columns(valid="ok")
    r = load_recording(write_recording(tmp_path, {**data, "ok": valid}, columns=columns))
    np.testing.assert_array_equal(r.valid, valid == 1)
    assert all(np.isfinite(x).all() for x in r.signals.values())
    np.testing.assert_allclose(r.position[:, 0], two_axes()["q_a"], atol=0.03)
    assert "10 of 400 rows are masked" in r.notes[0]


def test_missing_rows_are_filled_where_a_valid_column_exists(tmp_path: Path) -> None:
    data = {k: np.delete(v, np.arange(50, 54)) for k, v in two_axes().items()}
    flags = ["true"] * 396
    r = load_recording(write_recording(tmp_path, {**data, "ok": flags}, columns=with_columns(valid="ok")))
    assert len(r) == 400 and r.valid is not None
    np.testing.assert_array_equal(np.flatnonzero(~r.valid), [50, 51, 52, 53])
    np.testing.assert_array_equal(r.position[54:, 0], two_axes()["q_a"][54:])


@pytest.mark.parametrize("decimals", [4, 5, 9])
def test_rounding_of_the_time_column_is_no_jitter(tmp_path: Path, decimals: int) -> None:
    data = two_axes(1200, 1 / 3000)
    data["t"] = np.round(np.arange(1200) / 3000, decimals)
    r = load_recording(write_recording(tmp_path, data))
    assert r.notes == () and len(r) == 1200
    assert r.period == pytest.approx(1 / 3000, rel=1e-3)


def test_single_precision_time_is_no_jitter(tmp_path: Path) -> None:
    data = two_axes()
    t = (100 + data["t"]).astype(np.float32).astype(float)
    r = load_recording(write_recording(tmp_path, {**data, "t": t}))
    assert r.notes == () and r.period == pytest.approx(0.005, rel=1e-5)


def test_a_held_axis_is_no_error(tmp_path: Path) -> None:
    data = two_axes() | {k: [0.1] * 400 for k in ("q_b", "w_b", "ref_b")}
    assert np.ptp(load_recording(write_recording(tmp_path, data)).position[:, 1]) == 0


def test_a_held_axis_whose_command_answers_noise_is_no_error(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    data = two_axes() | {"q_b": [0.1] * 400, "ref_b": [0.1] * 400, "w_b": rng.normal(0, 0.01, 400)}
    data |= {"cmd_a": data["tau_a"], "cmd_b": -0.5 * np.asarray(data["w_b"])}
    columns = with_columns(torque_command=["cmd_a", "cmd_b"])
    held = load_recording(write_recording(tmp_path, data, columns=columns))
    assert np.ptp(held.position[:, 1]) == 0 and np.ptp(held.signals["torque_command"][:, 1]) > 0


def test_extras_are_kept(tmp_path: Path) -> None:
    columns = with_columns(ground_force=["q_a", "q_b", "tau_a"], base_height="tau_b")
    r = load_recording(write_recording(tmp_path, columns=columns, units={"force": "kN"}))
    assert r.extra["ground_force"].shape == (400, 3) and r.extra["base_height"].shape == (400, 1)
    np.testing.assert_allclose(r.extra["ground_force"][:, 0], 1e3 * two_axes()["q_a"])


@pytest.mark.parametrize("rate", [50.0, 200.0, 1000.0, 5000.0])
def test_velocity_is_derived_without_delay(tmp_path: Path, rate: float) -> None:
    t = np.arange(int(4 * rate)) / rate
    step = 2 * np.pi / 16384
    q = np.round(0.3 * np.sin(2 * np.pi * 1.5 * t) / step) * step
    path = write_recording(tmp_path, {"t": t, "q": q}, axes="a", columns={"time": "t", "position": "q"})
    r = load_recording(path)
    expected = 0.3 * 2 * np.pi * 1.5 * np.cos(2 * np.pi * 1.5 * t)
    assert r.derived == ("velocity",) and "derived" in r.notes[0]
    core = slice(len(t) // 20, -len(t) // 20)
    error = r.velocity[core, 0] - expected[core]
    assert np.sqrt(np.mean(error**2)) < 0.02 * expected.std()
    lag = np.argmax([r.velocity[core, 0] @ np.roll(expected, k)[core] for k in (-1, 0, 1)]) - 1
    assert lag == 0


@given(
    start=st.floats(-1e3, 1e3),
    period=st.floats(2e-4, 0.5),
    rows=st.integers(20, 200),
    masked=st.sets(st.integers(1, 18), max_size=5),
)
def test_any_uniform_clock_is_found(
    tmp_path_factory: pytest.TempPathFactory, start: float, period: float, rows: int, masked: set[int]
) -> None:
    folder = tmp_path_factory.mktemp("clock")
    k = np.delete(np.arange(rows), sorted(masked))
    data = {"t": start + k * period, "q": np.sin(k), "ok": np.ones(len(k))}
    columns = {"time": "t", "position": "q", "valid": "ok"}
    r = load_recording(write_recording(folder, data, axes="a", columns=columns))
    assert len(r) == rows and r.period == pytest.approx(period, rel=1e-4)
    assert r.valid is not None and set(np.flatnonzero(~r.valid)) == masked
    np.testing.assert_array_equal(r.position[k, 0], np.sin(k))


def test_patterns_are_sorted_and_named_once(tmp_path: Path) -> None:
    for name in ("b", "a"):
        (tmp_path / name).mkdir()
        write_recording(tmp_path / name, name=name)
    found = load_recordings([tmp_path / "*" / "made.toml", str(tmp_path / "b" / "made.toml")])
    assert [r.name for r in found] == ["a", "b"]


def test_leg_examples_read_fast_and_untouched() -> None:
    for path in leg_examples():
        load_recording(path)
        begin = process_time()
        r = load_recording(path)
        assert process_time() - begin < 0.5, "0.04 s on an idle machine"
        assert r.notes == () and r.period == 0.001 and r.controller.coordinates == "joint"


def test_emps(tmp_path: Path) -> None:
    r = load_recording(emps_toml(tmp_path))
    assert r.units == ("m",) and len(r) == 24841 and r.period == 0.001
    assert r.derived == ("velocity",) and r.controller.limit == (10.0,)
    # the published model explains the force from this derived motion
    v, a = r.velocity[:, 0], np.gradient(r.velocity[:, 0], r.period)
    x = np.column_stack([a, v, np.tanh(v / 1e-3), np.ones(len(v))])
    found, *_ = np.linalg.lstsq(x, r.signals["torque_measured"][:, 0], rcond=None)
    assert found[0] == pytest.approx(95.1, rel=0.03) and found[1] == pytest.approx(203.5, rel=0.05)


def test_kuka_channels(tmp_path: Path) -> None:
    table = data_folder("kuka_kr300") / "run_A.mat"
    columns = {
        "time": "rec.time_cont",
        "position": [f"rec.act_pos_mot_deg[{i}]" for i in range(6)],
        "velocity": [f"rec.act_vel_mot_deg_per_s[{i}]" for i in range(6)],
    }
    content = description(
        table=str(table.resolve()),
        axes=[f"a{i}" for i in range(1, 7)],
        columns=columns,
        units={"position": "deg", "velocity": "deg/s"},
    )
    r = load_recording(write_toml(tmp_path / "kuka.toml", content))
    assert r.position.shape == (2501, 6) and r.period == 0.004
    assert np.corrcoef(np.gradient(r.position[:, 0], r.period), r.velocity[:, 0])[0, 1] > 0.99


def test_a_log_that_changes_its_rate_is_resampled_and_whole(tmp_path: Path) -> None:
    steps = np.concatenate([np.full(300, 0.0035), np.full(200, 0.0054)])
    steps = steps * (1.0 + 0.05 * np.random.default_rng(1).uniform(-1.0, 1.0, 500))
    data = two_axes(500)
    t = np.cumsum(steps)
    data["q_a"], data["t"] = np.sin(2.0 * t), t
    recording = load_recording(write_recording(tmp_path, data))
    assert recording.valid.all() and any("jitter" in note for note in recording.notes)
    away = recording.position[:, 0] - np.sin(2.0 * (recording.time + t[0]))
    assert np.abs(away).max() < 1e-4
