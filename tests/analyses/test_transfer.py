"""The transfer study in small: S3N-Full from recordings alone is ahead, and the metrics are the paper's."""

from pathlib import Path

import chirp_response
import closed_loop
import numpy as np
import pytest
import transfer_runs
import transfer_study
from figure_table import figures, measured
from transfer_chirp import reduction
from transfer_floor import ON_PLATE, identified_law
from transfer_measures import push_answer
from transfer_paired import Spread, ladder
from transfer_plants import SETS, other_leg
from transfer_runs import Job, Kept
from transfer_tables import spread
from transfer_worlds import Push

from workbench.core import Controller, Excitation, Recording
from workbench.rigs import VirtualLeg
from workbench.training.machine import STEP_S
from workbench.training.rollout import HOLD_S

#: Columns of the quick tables.
QUICK = ("Kin-Only", "S3N-Act", "S3N-Full")


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("study")


def found(figure: str, folder: Path, *rows: str) -> dict[str, float]:
    """What `make figures` would read of a study's tables, of the clean set's rows with these names."""
    [table] = [f for f in figures() if f["id"] == figure]
    chosen = [v for v in table["values"] if (not rows or v["row"] in rows) and not v.get("take")]
    chosen = [v for v in chosen if v["column"] in QUICK] if not rows else chosen
    values = [v for v in chosen if not v["file"].startswith("hidden")]
    assert values
    return {v["name"]: measured(v, folder, "") for v in values}


def test_the_contact_free_leg(tmp_path: Path) -> None:
    [(_, trial)] = chirp_response.main(["--quick", "--out", str(tmp_path)])
    less = [reduction(errors, "s3n_full") for errors in (trial.position, trial.torque)]
    assert less[0] > 80.9 and less[1] > 82.1  # the paper's
    assert trial.found == ("linkage_gravity",)
    np.testing.assert_allclose(trial.position["found"], trial.position["noise"], rtol=0.15)
    np.testing.assert_allclose(trial.torque["found"], trial.torque["noise"], rtol=0.15)
    stated = found("chirp_clean", tmp_path, "S3N-Full", "S3N + found effects")
    assert stated["position"] == pytest.approx(less[0], abs=0.06) and stated["over"] == pytest.approx(1, 0.15)
    files = {p.name for p in tmp_path.iterdir()}
    assert {"clean_reference_leg.md", "clean_curves.png", "clean_drive_hip.png", "chirp.csv"} <= files


def test_a_lap_pitch_and_a_jump_tell_simulators_apart(study: Path) -> None:
    """The quick size of three questions, with the models and runs of one folder."""
    lap = transfer_study.main(["gait", "--quick", "--out", str(study)])
    for measure in ("swing leg's knee", "swing leg's hip", "joint angles over the stride"):
        own = [lap[measure][s] for s in ("kin_only", "s3n_act", "s3n_full")]
        assert (own[0] > own[1]).all() and (own[1] > own[2]).all(), measure
    assert (lap["E_phi"]["hardware again"] < lap["E_phi"]["kin_only"]).all()
    jumped = transfer_study.main(["script", "--quick", "--out", str(study)])["take-off speed"]
    assert jumped["kin_only"][0] > 5.0 > 3.0 > jumped["s3n_act"][0] > jumped["hardware again"][0]
    pitched = transfer_study.main(["pitch", "--quick", "--out", str(study)])
    assert (pitched["force on a foot, RMSE"]["kin_only"] > pitched["force on a foot, RMSE"]["s3n_full"]).all()
    files = {p.name for p in study.iterdir()}
    assert {f"{q}_clean.{end}" for q in ("gait", "script", "pitch") for end in ("md", "csv", "png")} <= files
    for figure, name in (("gait", "stride_kin_only"), ("script", "kin_only"), ("pitch", "kin_only")):
        assert name in found(figure, study)


def test_pushes_a_trot_laws_and_estimators_are_told_apart(study: Path) -> None:
    """The quick size of four more questions."""
    pushed = transfer_study.main(["push", "--quick", "--out", str(study)])["sideward speed, mean answer"]
    assert pushed["kin_only"][0] > pushed["hardware again"][0]
    trotted = transfer_study.main(["trot", "--quick", "--out", str(study)])
    for measure in ("swing leg's knee", "swing leg's hip"):
        assert (trotted[measure]["kin_only"] > 4.0 * trotted[measure]["s3n_full"]).all()
    seen = transfer_study.main(["estimator", "--quick", "--out", str(study)])
    point, known = (seen[f"leg odometry, {foot}: E_phi"] for foot in ("foot a point", "radius known"))
    filtered, true = seen["Kalman filter, radius known: E_phi"], seen["motion capture: E_phi"]
    for name in ("kin_only", "s3n_full"):
        assert point[name][0] > known[name][0] > true[name][0] and point[name][0] > filtered[name][0]
    laws = transfer_study.main(["contact", "--quick", "--out", str(study)])
    assert {key.split(":")[0] for key in laws} == {"default", "training", "evaluation"}
    assert all(np.isfinite(v["s3n_full"]).all() for v in laws.values())
    damped = transfer_study.main(["damping", "--quick", "--out", str(study)])
    assert np.isfinite(damped["150 N s/m: foot force over the stride"]["s3n_full"]).all()


def test_trained_jumps_and_a_payload_tell_simulators_apart(study: Path) -> None:
    """The quick size of the two questions whose policies are trained with stiff feet."""
    jumped = transfer_study.main(["jump", "--quick", "--out", str(study)])
    for measure, times in (("take-off speed", 3.0), ("joint angles over the jump", 1.4)):
        assert (jumped[measure]["kin_only"] > times * jumped[measure]["s3n_full"]).all(), measure
    assert "kin_only" in found("jump", study)
    carried = transfer_study.main(["payload", "--quick", "--out", str(study)])
    for measure in ("swing leg's knee", "joint angles over the stride"):
        assert (carried[measure]["kin_only"] > 1.5 * carried[measure]["s3n_full"]).all(), measure


def test_the_paper_s_own_implementation_is_a_row_of_its_design(study: Path) -> None:
    """Each policy in its own simulator: injecting in steps of 3 ms is further away."""
    own = transfer_study.main(["paper", "--quick", "--out", str(study)])
    full, injected = (own[f"{method}, 6 ms, 3 ms: E_phi"] for method in ("s3n_full", "explicit"))
    assert injected["explicit"][0] > full["s3n_full"][0]
    assert {f"explicit, {law}: E_phi" for law in ("6 ms, 0.5 ms", "6 ms, 3 ms", "20 ms, 3 ms")} <= set(own)
    assert np.isfinite(own["s3n_full, 6 ms, 0.5 ms: force on a foot, RMSE"]["s3n_full"]).all()
    table = (study / "paper_clean.md").read_text(encoding="utf-8")
    assert "| S3N-Full, injected | 6 ms, 3 ms |" in table and "Kin-Only HR" not in table


def test_the_law_of_the_ground_comes_from_the_plate(study: Path) -> None:
    models = study / "models"
    law = identified_law(models / "clean_s3n_full.toml", models, 0)
    assert law.stiffness == pytest.approx(ON_PLATE.ground_stiffness, rel=0.05)
    assert law.friction == pytest.approx(ON_PLATE.friction, abs=0.04)
    assert law.damping == pytest.approx(ON_PLATE.ground_damping, abs=30.0)
    assert identified_law(models / "clean_s3n_full.toml", models, 0) == law  # what is there is kept


def test_an_answer_to_pushes_has_no_turn_and_no_stride_in_it() -> None:
    push, t = Push(50.0, first_s=0.3, every_s=0.3), STEP_S * np.arange(round((HOLD_S + 2.1) / STEP_S))
    since = np.maximum(t - HOLD_S - 0.3, 0.0)
    sign = np.where((since // 0.3).astype(int) % 2 == 0, 1.0, -1.0)
    side = 0.4 * sign * np.exp(-(since % 0.3) / 0.1) * (t >= HOLD_S + 0.3) + 0.07  # drifts to the left
    level = np.tile([1.0, 0.0, 0.0, 0.0], (len(t), 1))
    log = Recording(
        name="pushed", axes=("a",), coordinates="actuator", time=t,
        signals={"position": np.zeros((len(t), 1))}, units=("rad",),
        controller=Controller("pd", "joint", kp=(1.0,), kd=(0.0,), period_s=STEP_S),
        excitation=Excitation("policy"),
        extra={"base_orientation": level, "base_velocity": np.stack([0 * t, side, 0 * t], axis=1)},
    )  # fmt: skip
    speed, roll = push_answer(log, push)
    assert speed.max() == pytest.approx(0.4, rel=0.05) and speed[-1] == pytest.approx(
        0.4 * np.exp(-3), abs=0.02
    )
    assert not roll.any()


def test_runs_are_computed_once(study: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    transfer_study.main(["script", "--quick", "--out", str(study)])
    monkeypatch.setattr(transfer_runs, "jump", None)
    transfer_study.main(["script", "--quick", "--out", str(study)])
    other = Job(0.0, 99)
    with pytest.raises(TypeError):
        Kept(study / "runs")(other)


def test_the_whole_way_round(tmp_path: Path) -> None:
    kin_only, full, last = closed_loop.main(["--quick", "--out", str(tmp_path)])
    assert last.found == ("linkage_gravity",) and not last.faults
    assert kin_only.gap[0] > full.gap[0] > last.gap[0]
    assert last.gap[0] < 1.5 * last.noise[0]
    stated = found("closed_loop", tmp_path, "Kin-Only", "S3N-Full", "S3N + found effects")
    assert stated["found"] == pytest.approx(last.gap[0] / last.noise[0], abs=0.01)


def test_a_ladder_is_of_paired_differences() -> None:
    """Pairs that differ by more than they scatter are told apart, whatever their own spread."""
    pairs = np.array([1.0, 5.0, 9.0, 13.0])
    scattered = pairs + np.array([0.5, -0.5, 0.4, -0.4])
    assert ladder({"a": pairs + 1.0, "b": pairs, "c": scattered}) == "a > b = c"
    assert ladder({"a": pairs, "b": pairs + 1.0}) == "a < b"
    one = Spread.of(np.array([1.0, np.nan, 3.0]))
    assert one.mean == 2.0 and one.half == pytest.approx(12.706, rel=1e-3)  # Student's t of one degree
    assert Spread.of(np.array([2.0])).text() == "2.00" and Spread.of(np.array([])).text() == "–"


def test_other_legs_are_legs_that_the_rig_can_be() -> None:
    for which in SETS:
        legs = [other_leg(which, seed) for seed in range(4)]
        assert len({leg.hidden[0].parameters["inertia"] for leg in legs}) == 4
        for leg in legs:
            VirtualLeg(leg.hidden)


def test_spread_is_mean_and_sample_deviation() -> None:
    assert spread([1.0, 3.0], 2) == "2.00 ± 1.41" and spread([2.0, np.nan], 1) == "2.0" and spread([]) == "–"
