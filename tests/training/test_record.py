"""Only a model that was held against measurements trains without being told to."""

from dataclasses import replace
from pathlib import Path

import pytest

from tests.models.make import leg_in_pieces
from workbench.effects import load_model
from workbench.models import write_model
from workbench.rigs import VirtualLeg, demo_experiments
from workbench.training.record import make_record, objections, read_record, record_path, write_record


@pytest.fixture(scope="module")
def recordings() -> list:
    experiment = next(e for e in demo_experiments() if e.name == "slow")
    return VirtualLeg(seed=4).run([experiment])


def test_a_model_that_explains_the_data_may_train(recordings: list, tmp_path: Path) -> None:
    write_model(load_model("leg"), tmp_path / "mine.toml")
    model = load_model(str(tmp_path / "mine.toml"))
    assert objections(read_record(record_path(model)), model, "exact") == [
        "the model has no verification record"
    ]
    write_record(make_record(model, recordings, samples=5), record_path(model))
    record = read_record(record_path(model))
    assert record is not None and record["passed"] and record["recordings"][0]["name"] == recordings[0].name
    assert objections(record, model, "exact") == []
    assert objections(record, model, "kin_only") == ["the record is for variant exact, not kin_only"]
    write_model(replace(model, sliding_speed=0.001), tmp_path / "mine.toml", force=True)
    assert objections(record, load_model(str(tmp_path / "mine.toml")), "exact") == [
        "the record is stale: mine.toml changed since"
    ]


def test_a_record_is_stale_where_a_file_of_the_mjcf_changed(recordings: list, tmp_path: Path) -> None:
    model = load_model(leg_in_pieces(tmp_path))
    record = make_record(model, recordings, samples=5)
    assert objections(record, model, "exact") == []
    for name in ("parts/option.xml", "meshes/thin/link.obj"):
        file = tmp_path / "tree" / name
        file.write_text(file.read_text() + "\n")
    (why,) = objections(record, model, "exact")
    assert why == "the record is stale: meshes/thin/link.obj, parts/option.xml changed since"


def test_a_model_that_does_not_explain_the_data_may_not(recordings: list) -> None:
    model = load_model("leg_kin_only")
    (why,) = objections(make_record(model, recordings, samples=5), model, "kin_only")
    assert "and noise alone explains" in why
