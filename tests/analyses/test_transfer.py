"""The transfer study in small: S3N-Full from recordings alone is ahead, and the metrics are the paper's."""

from pathlib import Path

import chirp_response
import circular_locomotion
import closed_loop
import numpy as np
import pitch_in_place
import pytest
from figure_table import figures, measured
from transfer_chirp import reduction
from transfer_plants import SETS, other_leg
from transfer_policies import Rollout
from transfer_tables import spread

from workbench.rigs import VirtualLeg
from workbench.training.machine import STEP_S


def found(figure: str, folder: Path, *rows: str) -> dict[str, float]:
    """What `make figures` would read of a study's tables, of the clean set's rows with these names."""
    [table] = [f for f in figures() if f["id"] == figure]
    chosen = [v for v in table["values"] if v["row"] in rows and not v.get("take")]
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


def test_pitch_in_place(tmp_path: Path) -> None:
    results = pitch_in_place.main(["--quick", "--out", str(tmp_path)])["clean"]
    for name in ("Kin-Only", "S3N-Full"):
        assert 5.5 < results[name].range_rad_s[0] < 7.5  # the command has 6.28
        assert results[name].pitch_percent[0] < 15.0 and results[name].force[0] < 40.0
    assert (tmp_path / "pitch.png").stat().st_size > 10_000
    assert set(found("pitch", tmp_path, "S3N-Full")) == {"full"}


def test_circular_locomotion(tmp_path: Path) -> None:
    results = circular_locomotion.main(["--quick", "--out", str(tmp_path)])["clean"]
    for gap in results.values():
        assert 0.2 < gap.phase[0, 0] < 15.0 and gap.local.shape == (1, 1, 18)
    stated = found("circular", tmp_path, "Kin-Only", "S3N-Full")
    assert list(stated.values()) == pytest.approx([g.phase[0, 0] for g in results.values()], abs=0.01)


def test_the_whole_way_round(tmp_path: Path) -> None:
    kin_only, full, last = closed_loop.main(["--quick", "--out", str(tmp_path)])
    assert last.found == ("linkage_gravity",) and not last.faults
    assert kin_only.gap[0] > full.gap[0] > last.gap[0]
    assert last.gap[0] < 1.5 * last.noise[0]
    stated = found("closed_loop", tmp_path, "Kin-Only", "S3N-Full", "S3N + found effects")
    assert stated["found"] == pytest.approx(last.gap[0] / last.noise[0], abs=0.01)


def test_the_circle_s_metrics_are_those_of_the_equations() -> None:
    t = STEP_S * np.arange(round(circular_locomotion._LAP_S / STEP_S))
    still = np.zeros_like(t)
    simulation = Rollout(still + 0.8, still + 0.8, still, still, None)
    hardware = Rollout(still + 0.72, 0.8 + 0.16 * np.sign(np.sin(40.0 * t)), still, still, None)
    gap = circular_locomotion.gap([[hardware, hardware], [simulation, hardware]], [simulation, simulation])
    assert gap.local.shape == (2, 2, 72) and gap.again[0].tolist() == [0.0]
    np.testing.assert_allclose(gap.phase, [[15.0, 15.0], [0.0, 15.0]], rtol=5e-3)  # half of 10 % and 20 %
    np.testing.assert_allclose(gap.whole, gap.phase, rtol=1e-2)
    assert gap.forward[0, 0] == pytest.approx(0.08) and gap.again[1, 0] == pytest.approx(gap.phase[0, 0])
    assert circular_locomotion.of_seeds(gap.phase, 0) == "11 ± 5"
    assert float(circular_locomotion.within(gap.phase)) == pytest.approx(7.5, abs=0.05)
    short = still[:200]
    fallen = Rollout(short, short, short, short, 0.5)
    for own in (simulation, fallen):
        gap = circular_locomotion.gap([[fallen, hardware], [hardware, hardware]], [own, simulation])
        assert np.isnan(gap.phase[0, 0]) and gap.local.shape == (2, 2, 72)
        assert np.isnan(gap.phase[0, 1]) == (own is fallen) and np.isfinite(gap.phase[1]).all()


def test_a_shift_in_phase_is_a_gap_and_a_whole_cycle_is_none() -> None:
    t = STEP_S * np.arange(round(2.3 / STEP_S))
    flat = np.zeros_like(t)

    def swing(lag: float) -> Rollout:
        return Rollout(flat, flat, 3.0 * np.sin(10 * np.pi * (t - lag)), 40.0 + flat, None)

    late, same = (pitch_in_place.result([swing(lag)], [swing(0.0)], 4) for lag in (0.01, 0.2))
    wanted = 100.0 * 2.0 * 3.0 * np.sin(0.05 * np.pi) / np.sqrt(2.0) / 6.0
    assert late.pitch_percent[0] == pytest.approx(wanted, rel=0.01)
    assert same.pitch_percent[0] < 0.1 and late.force[0] == 0.0


def test_other_legs_are_legs_that_the_rig_can_be() -> None:
    for which in SETS:
        legs = [other_leg(which, seed) for seed in range(4)]
        assert len({leg.hidden[0].parameters["inertia"] for leg in legs}) == 4
        for leg in legs:
            VirtualLeg(leg.hidden)


def test_spread_is_mean_and_sample_deviation() -> None:
    assert spread([1.0, 3.0], 2) == "2.00 ± 1.41" and spread([2.0, np.nan], 1) == "2.0" and spread([]) == "–"
