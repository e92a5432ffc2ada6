"""A dry run turns the robot that the configuration names, and says so."""

from __future__ import annotations

from pathlib import Path

from tests.bench_arm import AXES, bench_arm
from tests.can.make import motor, table, written
from tests.cli.here import run

WIDE = {"position": [-3.0, 3.0], "velocity": 20.0, "torque": 9.0}


def ran(folder: Path, axes: tuple[str, ...], **mechanism: object) -> tuple[int, str]:
    """Exit code and all that a dry run of the tracker said."""
    motors = [motor(axis, k + 1, limits=WIDE) for k, axis in enumerate(axes)]
    loop = {"period_s": 0.003, "kp": 20.0, "kd": 2.0}
    file = written(folder, table(motors, loop=loop, mechanism=[{"axes": list(axes), **mechanism}]))
    done = run("deploy", "tracker", file, "--dry-run", "--seconds", 1)
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
