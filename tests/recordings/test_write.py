"""What is written comes back, whole or not at all."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from workbench.core import Controller, Excitation, InputError, Recording, Timing
from workbench.recordings import load_recording, save_recording


def made(rows: int = 60, period: float = 0.002, **changes: object) -> Recording:
    rng = np.random.default_rng(rows)
    signals = {
        s: rng.normal(size=(rows, 2)) for s in ("position", "velocity", "torque_command", "temperature")
    }
    values = {
        "name": "made",
        "axes": ("hip", "slide"),
        "coordinates": "actuator",
        "time": np.arange(rows) * period,
        "signals": signals,
        "units": ("rad", "m"),
        "controller": Controller("pd", "joint", kp=(1.0, 2.0), kd=(0.5, 0.1), period_s=0.004),
        "excitation": Excitation("chirp", f_max_hz=20.0),
        "timing": Timing(feedforward_held=False),
        "rig": "bench",
        "extra": {"ground_force": rng.normal(size=(rows, 3))},
        **changes,
    }
    return Recording(**values)  # type: ignore[arg-type]


@given(rows=st.integers(30, 80), period=st.sampled_from([1e-3, 2e-4, 1 / 300, 0.004]), compress=st.booleans())
def test_round_trip(
    tmp_path_factory: pytest.TempPathFactory, rows: int, period: float, compress: bool
) -> None:
    path = tmp_path_factory.mktemp("trip") / "r.toml"
    before = made(rows, period)
    save_recording(before, path, compress=compress)
    assert path.with_suffix(".csv.gz").exists() == compress
    after = load_recording(path)
    for name in (
        "name",
        "axes",
        "coordinates",
        "units",
        "controller",
        "excitation",
        "timing",
        "rig",
        "notes",
    ):
        assert getattr(after, name) == getattr(before, name), name
    np.testing.assert_allclose(after.time, before.time, rtol=1e-9)
    assert after.signals.keys() == before.signals.keys()
    for name, values in before.signals.items():
        np.testing.assert_array_equal(after.signals[name], values)
    np.testing.assert_array_equal(after.extra["ground_force"], before.extra["ground_force"])


def test_cascade_without_limit(tmp_path: Path) -> None:
    controller = Controller("cascade_pv", kp=(1.0, 1.0), kv=(2.0, 2.0), gain=(3.0, 3.0))
    save_recording(made(controller=controller), tmp_path / "r.toml")
    assert load_recording(tmp_path / "r.toml").controller == controller


def test_masks_come_back(tmp_path: Path) -> None:
    valid = np.ones(60, bool)
    valid[20:23] = False
    save_recording(made(valid=valid), tmp_path / "r.toml")
    np.testing.assert_array_equal(load_recording(tmp_path / "r.toml").valid, valid)


def test_derived_velocity_is_not_written_as_measured(tmp_path: Path) -> None:
    save_recording(made(derived=("velocity",)), tmp_path / "r.toml")
    assert load_recording(tmp_path / "r.toml").derived == ("velocity",)


@pytest.mark.parametrize("there", ["r.toml", "r.csv.gz"])
def test_nothing_is_overwritten_unasked(tmp_path: Path, there: str) -> None:
    (tmp_path / there).write_text("mine")
    with pytest.raises(InputError, match="exists"):
        save_recording(made(), tmp_path / "r.toml")
    assert [p.name for p in tmp_path.iterdir()] == [there]
    assert (tmp_path / there).read_text() == "mine"
    save_recording(made(), tmp_path / "r.toml", force=True)
    assert load_recording(tmp_path / "r.toml").name == "made"


def test_same_recording_same_bytes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        save_recording(made(), tmp_path / name / "r.toml")
    first, second = (tmp_path / name / "r.csv.gz" for name in ("a", "b"))
    assert first.read_bytes() == second.read_bytes()


def test_name_must_be_a_toml(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not end in"):
        save_recording(made(), tmp_path / "r.csv")
