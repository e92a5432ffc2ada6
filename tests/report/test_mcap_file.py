"""A result as MCAP, read back by the reader of the mcap package."""

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

from workbench.core import Comparison, Improvement, InputError
from workbench.proposing.files import open_table
from workbench.report import write_mcap

from . import build

Topics = dict[str, tuple[dict[str, Any], list[tuple[float, dict[str, Any]]]]]


def topics(file: Path) -> Topics:
    """Topic -> its JSON schema, and time [s] and message of each row."""
    found: Topics = {}
    with file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert schema is not None and (schema.encoding, channel.message_encoding) == (
                "jsonschema",
                "json",
            )
            rows = found.setdefault(channel.topic, (json.loads(schema.data), []))[1]
            rows.append((message.log_time * 1e-9, json.loads(message.data)))
    return found


@pytest.fixture(scope="module")
def improvement() -> Improvement:
    """Rows are written one by one: a tenth of those of a page are enough."""
    return build.improvement(rate=50.0)


@pytest.fixture(scope="module")
def comparison(improvement: Improvement) -> Comparison:
    assert improvement.before is not None
    return improvement.before


def test_every_recording_has_its_measured_and_simulated_rows(comparison: Comparison, tmp_path: Path) -> None:
    found = topics(write_mcap(comparison, tmp_path / "result.mcap"))
    assert sorted(found) == [
        f"/{name}/{what}"
        for name in ("chirp_hip", "chirp_knee")
        for what in ("measured", "residual", "simulated")
    ]
    for entry in comparison.recordings:
        real, valid = entry.recording, np.asarray(entry.recording.valid, bool)
        for what, signals in (("measured", real.signals), ("simulated", entry.simulated.signals)):
            schema, rows = found[f"/{real.name}/{what}"]
            assert set(schema["properties"]) == set(signals)
            np.testing.assert_allclose([t for t, _ in rows], real.time[valid], atol=1e-9)
            for name, values in signals.items():
                read = [[message[name][axis] for axis in real.axes] for _, message in rows]
                np.testing.assert_array_equal(read, values[valid])
        residual = [m["torque_measured"]["knee"] for _, m in found[f"/{real.name}/residual"][1]]
        np.testing.assert_array_equal(residual, entry.residual("torque_measured")[valid, 1])


def test_rows_come_in_the_order_of_time(comparison: Comparison, tmp_path: Path) -> None:
    with write_mcap(comparison, tmp_path / "result.mcap").open("rb") as stream:
        times = [m.log_time for _, _, m in make_reader(stream).iter_messages(log_time_order=False)]
    assert times == sorted(times)


def test_schemas_name_units(comparison: Comparison, tmp_path: Path) -> None:
    first = comparison.recordings[0]
    sliding = replace(first, recording=replace(first.recording, units=("rad", "m")))
    found = topics(write_mcap(replace(comparison, recordings=(sliding,)), tmp_path / "result.mcap"))
    of = found["/chirp_hip/measured"][0]["properties"]
    units = {name: [of[name]["properties"][axis]["description"] for axis in ("hip", "knee")] for name in of}
    assert units == {
        "position": ["rad", "m"],
        "velocity": ["rad/s", "m/s"],
        "torque_measured": ["N*m", "N"],
    }


def test_what_was_improved_stands_beside_what_was_given(improvement: Improvement, tmp_path: Path) -> None:
    found = topics(write_mcap(improvement, tmp_path / "result.mcap"))
    assert improvement.after is not None
    simulated = improvement.after.recordings[0].simulated.signals["position"][0]
    first = found["/chirp_hip/simulated_with_effects"][1][0][1]
    assert [first["position"][axis] for axis in ("hip", "knee")] == list(simulated)
    assert set(found["/chirp_hip/residual_with_effects"][1][0][1]) == {"position", "torque_measured"}


def test_recordings_of_one_name_have_topics_of_their_own(comparison: Comparison, tmp_path: Path) -> None:
    twice = replace(comparison, recordings=comparison.recordings[:1] * 2)
    found = topics(write_mcap(twice, tmp_path / "result.mcap"))
    assert found["/chirp_hip/measured"] == found["/chirp_hip_2/measured"]


def test_numbers_that_are_not_finite_are_left_out(comparison: Comparison, tmp_path: Path) -> None:
    first = comparison.recordings[0]
    position = first.simulated.signals["position"].copy()
    position[3, 1] = np.nan
    broken = replace(first, simulated=first.simulated.with_signals(position=position))
    found = topics(write_mcap(replace(comparison, recordings=(broken,)), tmp_path / "result.mcap"))
    assert set(found["/chirp_hip/simulated"][1][3][1]["position"]) == {"hip"}


def test_what_is_written_can_be_imported_as_any_log(comparison: Comparison, tmp_path: Path) -> None:
    table = open_table(write_mcap(comparison, tmp_path / "result.mcap"))
    assert "chirp_hip/measured.position.hip" in table.columns


def test_nothing_is_overwritten_and_a_missing_package_is_named(
    comparison: Comparison, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write_mcap(comparison, tmp_path / "result.mcap")
    with pytest.raises(InputError, match="--force"):
        write_mcap(comparison, file)
    again = write_mcap(comparison, tmp_path / "again.mcap")
    assert again.read_bytes() == file.read_bytes()
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    with pytest.raises(InputError, match="needs the package mcap; install it"):
        write_mcap(comparison, file, force=True)
