"""What is wrong with a configuration is said in one line; a bus that is too full is refused."""

import json
from pathlib import Path

import cantools.database
import pytest
from typer.testing import CliRunner

from tests.can.make import config, motor, table, written
from workbench.can import bus_load, load_config
from workbench.cli import can as _  # noqa: F401  (registers the command)
from workbench.cli.app import app
from workbench.core import InputError


@pytest.mark.parametrize(
    ("count", "protocol", "percent"),
    [(12, "damiao", 108), (12, "robstride", 128), (6, "mit", 54), (6, "robstride", 64), (3, "mit", 27)],
)
def test_load_is_the_published_one(tmp_path: Path, count: int, protocol: str, percent: float) -> None:
    motors = [motor(f"m{i}", i + 1, protocol=protocol) for i in range(count)]
    [load] = bus_load(config(tmp_path, motors))
    assert 100 * load.share == pytest.approx(percent, abs=0.5)
    assert load.fits == (percent <= 70)


@pytest.mark.parametrize(("count", "code"), [(6, 0), (12, 1)])
def test_a_full_bus_is_refused(tmp_path: Path, count: int, code: int) -> None:
    path = written(tmp_path, table([motor(f"m{i}", i + 1) for i in range(count)]))
    done = CliRunner().invoke(app, ["can", "load", str(path)])
    assert done.exit_code == code, done.output
    assert f"{54 if code == 0 else 108} %" in done.output
    told = CliRunner().invoke(app, ["can", "load", str(path), "--json", "-"])
    assert [each["file"] for each in json.loads(told.stdout)["provenance"]["inputs"]] == [path.name]


def test_a_dbc_is_written(tmp_path: Path) -> None:
    path = written(tmp_path, table([motor("hip", 1), motor("knee", 2)]))
    out = tmp_path / "robot.dbc"
    told = CliRunner().invoke(app, ["can", "dbc", str(path), "-o", str(out), "--json", "-"])
    assert told.exit_code == 0 and json.loads(told.stdout)["file"] == str(out)
    names = {m.name for m in cantools.database.load_file(out).messages}
    assert names == {"command_hip", "command_knee", "feedback_11", "feedback_12"}


def with_interface(interface: str, **more: object) -> dict:
    content = table([HIP], **more)
    content["bus"][0]["interface"] = interface
    return content


HIP, KNEE = motor("hip", 1), motor("knee", 2)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (table([HIP, motor("hip", 2)]), "axis 'hip' stands twice"),
        (table([HIP, motor("knee", 1)]), "id 0x1 is used by 'hip' too"),
        (table([HIP, {**KNEE, "reply_id": 1}]), "0x1 is also where 'hip' is commanded"),
        (table([HIP, {**KNEE, "bus": "can7"}]), "no bus is called 'can7'"),
        (table([{**HIP, "sing": -1}]), "did you mean 'sign'?"),
        (table([{**HIP, "limits": {**HIP["limits"], "torque": 40.0}}]), "40 is beyond the range of 25"),
        (table([{**HIP, "ranges": {"source": "a guess"}}]), "position': is missing"),
        (table([motor("hip", 1, protocol="mit", ranges={"source": "drive"})]), "do not tell their ranges"),
        (table([{**HIP, "watchdog_s": 0.2}]), "less than or equal to 0.025"),
        (table([HIP], loop={"period_s": 0.008}), "less than three periods"),
        (table([motor("hip", 1, protocol="mit", watchdog_source="")]), "cannot be read back"),
        (table([HIP], mechanism=[{"model": "leg", "axes": ["hip", "toe"]}]), "axis 'toe' has no motor"),
        (table([HIP], loop={"kp": [1.0, 2.0, 3.0]}), "has 3 values for 1 axes"),
        (table([HIP], loop={"damping": float("nan")}), "found nan"),
        (table([HIP], loop={"kp": True}), "true and false are no values here"),
        (table([{**HIP, "id": "two"}]), "motor 'hip'.id"),
        (table([HIP], bench={"time_scale": 0.5}), "greater than or equal to 1"),
        (table([HIP], imu={"bus": "can7", "id": 0x60}), "no bus is called 'can7'"),
        (table([HIP], imu={"bus": "can0", "id": 0x10}), "id 0x11 is used by 'hip' too"),
        (table([HIP], imu={"bus": "can0", "id": 0x7FF}), "outside 0x0 to 0x7fe"),
        (table([HIP], imu={"bus": "can0", "id": 0x60, "protocol": "x"}), "no unit is called 'x'"),
        (with_interface("socketcan", bench={"time_scale": 4.0}), "the drives on 'can0' keep real time"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, content: dict, said: str) -> None:
    with pytest.raises(InputError) as caught:
        load_config(written(tmp_path, content))
    assert said in str(caught.value) and "\n" not in str(caught.value)


def test_ranges_may_be_the_drives_own(tmp_path: Path) -> None:
    assert config(tmp_path, [{**HIP, "ranges": {"source": "drive"}}]).motor[0].reads_ranges
