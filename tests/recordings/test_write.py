"""What is written comes back, whole or not at all."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, find, given, settings
from hypothesis import strategies as st

from workbench.core import Controller, Excitation, InputError, Recording, Timing
from workbench.recordings import load_recording, save_recording
from workbench.recordings.description import ControllerTable, Description, ExcitationTable, TimingTable


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


@settings(max_examples=40)
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


_GAIN = st.floats(1e-3, 1e3)
_GAINS = st.tuples(_GAIN, _GAIN)
_KINDS = st.lists(st.sampled_from(["position", "velocity", "torque"]), unique=True)
_PERIOD = st.none() | st.floats(1e-4, 0.1)
_WHERE = st.sampled_from(["joint", "actuator"])
#: What the TOML may say; with every key of it, so that a new one cannot be forgotten here.
_TOLD = st.fixed_dictionaries(
    {
        "name": st.text("abc-_ äß\"'.", min_size=1).filter(str.strip),
        "rig": st.text("rig 1\\", max_size=5),
        "axes": st.sampled_from([("hip", "slide"), ("a.b", "ä")]),
        "coordinates": _WHERE,
        "units": st.tuples(*2 * [st.sampled_from(["rad", "m"])]),
        "guessed_units": _KINDS.map(tuple),
        "controller": st.one_of(
            st.builds(Controller, st.sampled_from(["none", "unknown"]), _WHERE, period_s=_PERIOD),
            st.builds(
                Controller,
                st.just("pd"),
                _WHERE,
                kp=_GAINS,
                kd=_GAINS,
                limit=_GAINS,
                period_s=_PERIOD,
                velocity=st.none() | st.sampled_from(["sensor", "difference"]),
            ),
            st.builds(
                Controller, st.just("cascade_pv"), _WHERE, kp=_GAINS, kv=_GAINS, gain=_GAINS, period_s=_PERIOD
            ),
        ),
        "excitation": st.builds(
            Excitation,
            st.sampled_from(["chirp", "multisine", "reference", "policy", "hold", "random"]),
            st.sampled_from([None, "sum", "difference", "single"]),
            period_s=st.none() | st.just(0.05),
            f_min_hz=st.none() | st.floats(0.1, 5.0),
            f_max_hz=st.none() | st.floats(6.0, 200.0),
            lines=st.sampled_from([None, "odd", "every_4", (1, 5, 9)]),
        ),
        "timing": st.builds(
            Timing,
            st.booleans(),
            st.booleans(),
            st.sampled_from(["motor", "loop"]),
            st.none() | st.booleans(),
        ),
    }
)  # fmt: skip


@settings(max_examples=40)
@given(told=_TOLD)
def test_all_that_is_told_comes_back(tmp_path_factory: pytest.TempPathFactory, told: dict[str, Any]) -> None:
    path = tmp_path_factory.mktemp("trip") / "r.toml"
    save_recording(made(**told), path, compress=False)
    after = load_recording(path)
    assert {name: getattr(after, name) for name in told} == told


def test_no_key_of_the_file_is_forgotten_here() -> None:
    first = settings(phases=[Phase.generate], max_examples=1)  # the smallest is not needed
    example: dict[str, Any] = find(_TOLD, lambda told: True, settings=first)
    assert {*example, "format", "table", "columns"} == set(Description.model_fields)
    tables = {"controller": ControllerTable, "excitation": ExcitationTable, "timing": TimingTable}
    for part, table in tables.items():
        assert set(table.model_fields) == {f.name for f in fields(example[part])}


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
