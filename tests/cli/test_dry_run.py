"""A dry run turns the robot that the configuration names, and says so."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.bench_arm import AXES, bench_arm
from tests.can.make import motor, table, written
from tests.cli.here import run
from workbench.comparison import compare
from workbench.effects import load_model
from workbench.recordings import load_recordings

WIDE = {"position": [-3.0, 3.0], "velocity": 40.0, "torque": 40.0}
STRONG = {"position": 12.5, "velocity": 45.0, "torque": 54.0, "source": "label of the drive"}


def ran(
    folder: Path, axes: tuple[str, ...], more: tuple[object, ...] = (), **mechanism: object
) -> tuple[int, str]:
    """Exit code and all that a dry run of the tracker said."""
    motors = [motor(axis, k + 1, limits=WIDE, ranges=STRONG) for k, axis in enumerate(axes)]
    loop = {"period_s": 0.003, "kp": 20.0, "kd": 2.0}
    file = written(folder, table(motors, loop=loop, mechanism=[{"axes": list(axes), **mechanism}]))
    done = run("deploy", "tracker", file, "--dry-run", "--seconds", 4, *more)
    return done.returncode, done.stdout + done.stderr


def test_it_turns_the_model_of_the_configuration(tmp_path: Path) -> None:
    code, said = ran(tmp_path, AXES, model=str(bench_arm(tmp_path)))
    assert code == 0, said
    assert f"{len(AXES)} drives ({', '.join(AXES)})" in said and "reference" not in said


def test_where_it_is_the_reference_leg_it_says_so(tmp_path: Path) -> None:
    assert "Virtual hardware: the reference leg" in ran(tmp_path, ("hip", "knee"), model="leg")[1]


def test_a_transmission_alone_is_no_hardware(tmp_path: Path) -> None:
    known = {"transmission": [[1.0, 0.0], [1.0, 1.0]], "limits": [[-1.6, 1.6], [0.35, 2.6]]}
    code, said = ran(tmp_path, ("hip", "knee"), **known)
    assert code == 2 and "only the transmission is known" in said and "Traceback" not in said


def test_a_run_is_a_recording_that_its_model_explains(tmp_path: Path) -> None:
    arm, out = bench_arm(tmp_path), tmp_path / "out"
    code, said = ran(tmp_path, AXES, ("-o", out), model=str(arm))
    assert code == 0 and f"Wrote {out / 'run.toml'}" in said
    (log,) = load_recordings([out / "run.toml"])
    assert log.axes == AXES and log.position.std(axis=0).min() > 0.01
    result = compare(load_model(arm), [log])
    assert result.error < 1.3 * result.noise_error

    # the frames and what was asked for say the same again
    again = run("record", tmp_path / "robot.toml", "--from-logs", "-o", out, "--force")
    assert again.returncode == 0, again.stderr
    np.testing.assert_array_equal(load_recordings([out / "run.toml"])[0].position, log.position)


def test_a_run_that_is_there_is_kept(tmp_path: Path) -> None:
    (out := tmp_path / "out").mkdir()
    (out / "run.log").write_text("of yesterday")
    code, said = ran(tmp_path, AXES, ("-o", out), model=str(bench_arm(tmp_path)))
    assert code == 2 and "run.log" in said and (out / "run.log").read_text() == "of yesterday"


def test_a_dry_run_is_not_steered(tmp_path: Path) -> None:
    """It was left out in silence."""
    code, said = ran(tmp_path, AXES, ("--teleop", "keys"), model=str(bench_arm(tmp_path)))
    assert code == 2 and "--teleop" in said and "Traceback" not in said


def test_a_run_that_is_refused_leaves_the_one_before(tmp_path: Path) -> None:
    (out := tmp_path / "out").mkdir()
    for name in ("run.log", "run.toml", "run.played.npz"):
        (out / name).write_text("of yesterday")
    file = written(tmp_path, table([motor("lift", 1)]))
    done = run("deploy", tmp_path / "gone.zip", file, "--dry-run", "-o", out, "--force")
    assert done.returncode == 2 and "gone.zip" in done.stderr
    assert {f.name: f.read_text() for f in out.iterdir()} == dict.fromkeys(
        ("run.log", "run.toml", "run.played.npz"), "of yesterday"
    )
    assert run("deploy", tmp_path / "gone.zip", file, "-o", tmp_path / "new").returncode == 2
    assert not (tmp_path / "new").exists()
