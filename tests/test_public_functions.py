"""Public functions take files and names as well as values; other kinds are refused in one sentence."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import workbench as wb
from tests.report import build
from workbench.core import InputError, Recording

TUTORIAL = Path(__file__).resolve().parents[1] / "docs" / "tutorial"
#: What is no model and no recording, nor a file of one.
WRONG: tuple[Any, ...] = (None, 3, [None], [["a.toml"]], {"position": [0.0]}, 1.5)


@pytest.fixture(scope="module")
def recording() -> Recording:
    before = build.improvement().before
    assert before
    return before.recordings[0].recording


@pytest.fixture(scope="module")
def file(recording: Recording, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("named") / "run.toml"
    wb.save_recording(recording, path)
    return path


def test_a_name_and_files_do_as_well_as_their_values(recording: Recording, file: Path) -> None:
    model, read = wb.load_model("leg"), wb.load_recording(file)
    expected = wb.compare(model, [read], draws=2)
    for given in (file, str(file), str(file.with_name("*.toml")), [file], (r for r in [read])):
        assert wb.compare("leg", given, draws=2).error == expected.error
    assert len(wb.compare(model, [file, recording], draws=2).recordings) == 2
    assert wb.load_model(model) is model and wb.load_recording(read) is read
    assert wb.inspect(file).recordings[0].recording == read.name
    assert len(wb.simulate(wb.Run(model, read))) == 1


def _calls(right: Recording) -> dict[str, Callable[[Any], Any]]:
    """Every argument that a model, a recording or a file is expected in."""
    return {
        "compare, model": lambda x: wb.compare(x, right),
        "compare, recordings": lambda x: wb.compare("leg", x),
        "diagnose, model": lambda x: wb.diagnose(x, right),
        "diagnose, training": lambda x: wb.diagnose("leg", x),
        "diagnose, held out": lambda x: wb.diagnose("leg", right, x),
        "improve, model": lambda x: wb.improve(x, right),
        "improve, training": lambda x: wb.improve("leg", x),
        "inspect": wb.inspect,
        "load_model": wb.load_model,
        "load_recording": wb.load_recording,
        "load_recordings": wb.load_recordings,
        "save_recording": lambda x: wb.save_recording(x, "never.toml"),
        "save_recording, file": lambda x: wb.save_recording(right, x),
        "simulate": wb.simulate,
        "Run, model": lambda x: wb.Run(x, right),
        "Run, recording": lambda x: wb.Run(wb.load_model("leg"), x),
        "import_table": wb.import_table,
        "import_table, model": lambda x: wb.import_table(TUTORIAL / "sweep.csv", [x]),  # pyright: ignore
    }


def test_what_is_of_another_kind_is_refused_in_one_sentence(recording: Recording) -> None:
    for name, call in _calls(recording).items():
        for wrong in WRONG:
            with pytest.raises(InputError) as refused:
                call(wrong)
            assert "expected" in str(refused.value), (name, wrong)


@pytest.mark.parametrize(
    "call", [wb.inspect, *(lambda x, f=f: f("leg", x) for f in (wb.compare, wb.improve))]
)
def test_no_recordings_are_not_taken_for_sound_ones(call: Callable[[Any], Any]) -> None:
    with pytest.raises(InputError, match="no recordings were given"):
        call([])


def test_arguments_of_an_import_are_told_their_names() -> None:
    arm, sweep = TUTORIAL / "arm.xml", TUTORIAL / "sweep.csv"
    with pytest.raises(InputError, match="there are axes, columns"):
        wb.import_table(sweep, arm, axis="lift")
    with pytest.raises(InputError, match=r'units=\{"position": "deg"}'):
        wb.import_table(sweep, arm, units="deg")
    one = wb.import_table(sweep, arm, kp=20.0, kd=(1.0,), likeliest=True)
    assert one.controller.kp == tuple(20.0 for _ in one.axes)
