from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from tests.data_helpers import write_recording
from workbench import compare, load_model, load_recordings
from workbench.core import Diagnosis, EffectKey, Estimate, Finding, InputError, SimulationError
from workbench.models import AppliedEffect
from workbench.ui import Bench, Shelf
from workbench.ui.live import Live
from workbench.ui.saving import Saving

from .conftest import FRICTION, Loop

KNEE = EffectKey("coulomb_friction", "knee")


def friction(torque: float) -> AppliedEffect:
    return AppliedEffect(KNEE, {"torque": Estimate(torque, 0.01, "N*m")})


@pytest.fixture
def bench(leg_folder: Path, tmp_path: Path) -> Bench:
    bench = Bench(Shelf.of(None, [], leg_folder), tmp_path)
    bench.choose(bench.read("leg", ["slow", "validation"], "validation"))
    return bench


def test_the_error_is_compare_s_and_falls_with_the_effect(bench: Bench, leg_folder: Path) -> None:
    chosen = bench.chosen
    assert chosen is not None
    before = bench.error(chosen, bench.simulate(bench.model, chosen, [0, 1]))
    recordings = load_recordings([str(leg_folder / f"{n}.toml") for n in ("slow", "validation")])
    whole = compare(load_model("leg"), recordings)
    assert before == pytest.approx(whole.error, rel=1e-12)
    bench.add(friction(FRICTION))
    after = bench.error(chosen, bench.simulate(bench.model, chosen, [0, 1]))
    assert after < 1.1 * whole.noise_error < 0.5 * before
    entries = bench.entries(chosen, bench.simulate(bench.model, chosen, [0, 1]), whole)
    assert (entries[0].torque_rmse < 1.3 * entries[0].torque_noise).all()


def test_a_diagnosis_is_fitted_to_all_but_the_one_that_judges(bench: Bench) -> None:
    assert bench.chosen is not None
    fitted, judging = bench.chosen.split()
    assert [r.name for r in fitted] == ["slow"] and [r.name for r in judging] == ["validation"]


def test_values_change_within_what_a_body_can_have(bench: Bench) -> None:
    bench.add(friction(0.2))
    index = len(bench.model.effects) - 1
    bench.set_value(index, "torque", 0.3)
    assert bench.model.effects[index].parameters["torque"] == Estimate(0.3, 0.0, "N*m")
    with pytest.raises(InputError, match="a body can physically have"):
        bench.set_value(index, "torque", -0.1)
    assert bench.model.effects[index].values == {"torque": 0.3}
    assert bench.has(KNEE)
    bench.remove(index)
    assert not bench.has(KNEE)


def test_what_cannot_be_chosen_leaves_all_as_it_was(bench: Bench, leg_folder: Path) -> None:
    bench.add(friction(0.2))
    chosen = bench.chosen
    with pytest.raises(InputError, match="axes"):
        bench.choose(bench.read("actuator", ["slow"]))
    with pytest.raises(InputError, match="no recordings"):
        bench.choose(bench.read("leg", []))
    assert bench.chosen is chosen and bench.has(KNEE)
    bench.choose(bench.read("leg", ["validation"], "validation"))
    assert bench.has(KNEE), "changes stay where only recordings are others"
    assert bench.chosen is not None and bench.chosen.held_out is None, "one alone cannot judge"
    bench.choose(bench.read("leg_kin_only", ["validation"]))
    assert not bench.has(KNEE)


def test_recordings_of_one_name_are_refused(tmp_path: Path) -> None:
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        write_recording(tmp_path / name, axes=["hip", "knee"])
    bench = Bench(Shelf.of(None, [], tmp_path), tmp_path)
    with pytest.raises(InputError, match="two of the recordings are named 'made'"):
        bench.read("leg", ["one/made.toml", "two/made.toml"])


def test_a_machine_that_cannot_be_is_refused(bench: Bench) -> None:
    assert bench.chosen is not None
    values = {name: Estimate(-0.1, 0, "kg*m^2") for name in ("M11", "M12", "M22")}
    bench.add(AppliedEffect(EffectKey("linkage_inertia", None), values))
    with pytest.raises(SimulationError):
        bench.simulate(bench.model, bench.chosen, [0])


def test_saving_writes_into_the_folder_and_over_nothing(bench: Bench) -> None:
    bench.add(friction(0.2))
    path = bench.save_model("better")
    assert path == bench.folder / "better.toml"
    assert load_model(path).effects[-1].values == {"torque": 0.2}
    with pytest.raises(InputError, match="the file exists"):
        bench.save_model("better.toml")
    bench.set_value(len(bench.model.effects) - 1, "torque", 0.3)
    bench.save_model("better.toml", force=True)
    assert load_model(path).effects[-1].values == {"torque": 0.3}


@pytest.mark.parametrize("name", ["", " ", "..", "../x", "a/b", "/tmp/x", ".hidden", "a\\b", "a\0b", "a\nb"])
def test_files_are_named_without_a_folder(bench: Bench, name: str) -> None:
    with pytest.raises(InputError, match="not a plain file name"):
        bench.save_model(name)
    assert list(bench.folder.iterdir()) == []


def test_the_report_says_how_to_make_it_again(bench: Bench, leg_folder: Path) -> None:
    assert bench.chosen is not None
    result = bench.compare(bench.model, bench.chosen)
    page = bench.save_report("report", result).read_text()
    assert "workbench compare leg slow.toml validation.toml" in page
    assert "does not explain the data" in page


def test_the_report_names_every_file_that_was_read(bench: Bench) -> None:
    assert bench.chosen is not None
    page = bench.save_report("report", bench.compare(bench.model, bench.chosen)).read_text()
    tables = [f"{name}.{end}" for name in ("slow", "validation") for end in ("toml", "csv.gz")]
    for name in ("leg.toml", "leg.xml", "leg.sdf", *tables):
        assert re.search(rf"{re.escape(name)}</th><td><code>[0-9a-f]{{64}}<", page), name


def test_the_report_of_a_changed_model_claims_no_command(bench: Bench) -> None:
    assert bench.chosen is not None
    plain = bench.compare(bench.model, bench.chosen)
    bench.diagnosed = bench.model
    bench.add(friction(0.2))
    assert bench.command(plain) == (
        "workbench compare CHANGED.toml slow.toml validation.toml"
        "  # save the model first: this result is of leg with changes"
    )
    found = Diagnosis("leg", "consistent", 0.1, 0.1, (), 0.0, (), None, ())
    assert bench.command(found) == "workbench diagnose leg slow.toml --holdout validation.toml"
    bench.diagnosed = bench.model
    assert bench.command(found).startswith("workbench diagnose CHANGED.toml slow.toml --holdout")
    bench.history.undo()
    assert bench.command(plain) == "workbench compare leg slow.toml validation.toml"


def test_commands_quote_what_a_shell_would_split(tmp_path: Path) -> None:
    folder = tmp_path / "a b"
    folder.mkdir()
    write_recording(folder, axes=["hip", "knee"])
    bench = Bench(Shelf.of(None, [], tmp_path), tmp_path)
    bench.choose(bench.read("leg", ["made"]))
    found = Diagnosis("leg", "consistent", 0.1, 0.1, (), 0.0, (), None, ())
    assert bench.command(found).startswith("workbench diagnose CHANGED.toml 'a b/made.toml'")
    bench.diagnosed = bench.model
    assert bench.command(found) == "workbench diagnose leg 'a b/made.toml'"


def test_a_diagnosis_is_reported_while_it_tells_of_the_model(bench: Bench) -> None:
    finding = Finding(KNEE, friction(0.2).parameters, 0.1, None, None, 0.9)
    found = Diagnosis("leg", "missing_effect", 0.2, 0.1, (finding,), 0.0, (), None, ())
    assert bench.told() is None
    bench.diagnosis, bench.diagnosed = found, bench.model
    assert bench.told() is found
    bench.add_finding(finding)
    assert bench.told() is found
    bench.add(AppliedEffect(EffectKey("coulomb_friction", "hip"), {"torque": Estimate(0.1, 0.01, "N*m")}))
    assert bench.told() is None
    assert bench.history is not None
    bench.history.undo()
    assert bench.told() is found
    bench.set_value(len(bench.model.effects) - 1, "torque", 0.3)
    assert bench.told() is None
    bench.diagnosis = replace(found)
    bench.history.undo()
    assert bench.told() is None, "of another diagnosis the findings are others"


def test_a_saved_report_is_of_the_model_as_it_is(live: Live, loop: Loop) -> None:
    live.choose("leg", ("slow",), None)
    loop.until(lambda: live.now and live.now.comparison)
    bench, saving = live.bench, Saving(live)
    finding = Finding(KNEE, friction(FRICTION).parameters, 0.1, None, None, 0.9)
    given = live.now.comparison  # type: ignore[union-attr]
    bench.diagnosis = Diagnosis(
        "leg", "missing_effect", 0.2, 0.1, (finding,), 0.0, (), None, (), before=given, after=given
    )
    bench.diagnosed = bench.model
    live.do(lambda: bench.add_finding(finding))
    saving._save_report()
    assert "page of the diagnosis" in live.message[0]
    hip = AppliedEffect(EffectKey("coulomb_friction", "hip"), {"torque": Estimate(0.1, 0.01, "N*m")})
    live.do(lambda: bench.add(hip))
    saving.over.value = True
    saving._save_report()
    assert live.message == ("The report is saved once the comparison is done.", False)
    saving.follow()
    assert "once the comparison" in live.message[0]
    loop.until(lambda: live.now and live.now.comparison)
    saving.follow()
    assert "page of the comparison" in live.message[0]
    assert "CHANGED.toml" in (bench.folder / "report.html").read_text()


def test_a_report_is_not_saved_after_something_went_wrong(live: Live, loop: Loop) -> None:
    live.choose("leg", ("slow",), None)
    loop.until(lambda: live.now and not live.now.comparison and live.bench.chosen)
    saving = Saving(live)
    saving._save_report()
    assert "once the comparison" in live.message[0]
    live.say("something went wrong", wrong=True)
    saving.follow()
    loop.until(lambda: live.now and live.now.comparison)
    saving.follow()
    assert list(live.bench.folder.iterdir()) == [] and live.message[1]


def test_unknown_loops_are_compared_too(leg_folder: Path, tmp_path: Path) -> None:
    text = (leg_folder / "slow.toml").read_text().replace("slow.csv.gz", str(leg_folder / "slow.csv.gz"))
    start = text.index("[controller]")
    end = text.index("[excitation]")
    (tmp_path / "blind.toml").write_text(text[:start] + text[end:])
    bench = Bench(Shelf.of(None, [], tmp_path), tmp_path)
    bench.choose(bench.read("leg", ["blind"]))
    chosen = bench.chosen
    assert chosen is not None
    assert bench.error(chosen, bench.simulate(bench.model, chosen, [0])) > 0
