"""What is wrong with a configuration is said in one line; a bus that is too full is refused."""

import json
import struct
from pathlib import Path

import cantools.database
import pytest
from typer.testing import CliRunner

from tests.can.make import config, motor, table, written
from workbench.can import bus_load, load_config
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


def test_the_load_of_bursts_and_of_two_rates(tmp_path: Path) -> None:
    [load] = bus_load(config(tmp_path, [ODRIVE]))
    # an exchange: 3 commands, 2 questions (55 bits), 2 answers; and 110 a second by itself (135 bits)
    assert load.bits == pytest.approx((5 * 135 + 2 * 55) / 0.003 + 110 * 135)
    [load] = bus_load(load_config(written(tmp_path, flexible([MOTEUS]))))
    assert load.share == pytest.approx(0.083, abs=0.001) and load.frames == pytest.approx(2 / 0.003)
    [slow] = bus_load(load_config(written(tmp_path, flexible([MOTEUS], rate=1_000_000))))
    assert slow.share > 2.5 * load.share


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


def test_an_odrive_may_close_its_loop_and_a_moteus_stand_by(tmp_path: Path) -> None:
    robstride, mit = (
        [motor(a, k, protocol=name, **more) for k, a in enumerate("ab")]
        for name, more in (("robstride", {}), ("mit", {"reply_id": 9}))
    )
    beside = [ODRIVE, {**HIP, "axis": "toe", "id": 2, "reply_id": 0x40}]
    for content, axes in [
        (table([ODRIVE], loop={"pd": "drive", "kd": 0.5}), 1),
        (table(robstride), 2),
        (table(mit), 2),
        (flexible([MOTEUS, {**MOTEUS, "axis": "toe", "id": 2}]), 2),
        (flexible([MOTEUS], rate=1_000_000), 1),
        (table(beside), 2),
    ]:
        assert len(load_config(written(tmp_path, content)).axes) == axes


def test_a_dbc_of_an_odrive_is_its_node_s_a_moteus_has_none(tmp_path: Path) -> None:
    content = table([ODRIVE, {**ODRIVE, "axis": "toe", "id": 3}, {**MOTEUS, "bus": "fd", "axis": "heel"}])
    content["bus"].append({**content["bus"][0], "name": "fd", "channel": "fd", "data_bitrate": 5_000_000})
    out = tmp_path / "robot.dbc"
    told = CliRunner().invoke(app, ["can", "dbc", str(written(tmp_path, content)), "-o", str(out)])
    assert (
        told.exit_code == 0
        and "2 drives. A DBC cannot describe a moteus, so the file leaves out heel" in told.output
    )
    database = cantools.database.load_file(out)
    assert len(database.messages) == 26
    motion = database.get_message_by_name("motion_toe")
    assert motion.frame_id == 3 << 5 | 9
    assert motion.decode(struct.pack("<ff", 0.25, -2.0)) == {"position": 0.25, "velocity": -2.0}


def with_interface(interface: str, **more: object) -> dict:
    content = table([HIP], **more)
    content["bus"][0]["interface"] = interface
    return content


ENDS = {"watchdog_timeout": 1, "enable_watchdog": 2}
HIP, KNEE = motor("hip", 1), motor("knee", 2)
ODRIVE = motor("hip", 1, protocol="odrive", watchdog_source="odrivetool")
MOTEUS = motor("hip", 1, protocol="moteus", reply_id=0, ranges={**HIP["ranges"], "kd": 1.0})


def flexible(motors: list[dict], rate: int = 5_000_000, **more: object) -> dict:
    content = table(motors, **more)
    content["bus"][0]["data_bitrate"] = rate
    return content


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (table([HIP, motor("hip", 2)]), "axis 'hip' is given twice"),
        (table([HIP, motor("knee", 1)]), "id 0x1 is used by 'hip' too"),
        (table([HIP, {**KNEE, "reply_id": 1}]), "0x1 is also where 'hip' is commanded"),
        (table([{k: v for k, v in HIP.items() if k != "reply_id"}]), "reply_id': is missing"),
        (
            table([{**HIP, "endpoints": ENDS}]),
            "damiao drive has none",
        ),
        (
            table([HIP, motor("toe", 2, protocol="mit", reply_id=0x11)]),
            "drives of damiao and mit answer on 0x11",
        ),
        (table([motor(axis, 1, protocol="robstride") for axis in ("hip", "toe")]), "id 0x1 is used twice"),
        (table([ODRIVE | {"watchdog_source": ""}]), "this odrive drive cannot be read back"),
        (table([ODRIVE, {**HIP, "axis": "toe", "id": 2, "reply_id": 0x21}]), "'toe' uses 0x21 too"),
        (table([ODRIVE, {**ODRIVE, "axis": "toe"}]), "'toe' uses 0x20 too"),
        (table([ODRIVE | {"endpoints": {"watchdog_timeout": 1}}]), "enable_watchdog': is missing"),
        (table([ODRIVE | {"endpoints": {**ENDS, "watchdg": 1}}]), "did you mean 'enable_watchdog'?"),
        (table([ODRIVE], loop={"pd": "drive", "kd": 0.0, "kp": 5.0}), "needs damping to have stiffness"),
        (table([ODRIVE], stop={"bus": "can0", "id": 0x3F}), "id 0x3f is used by another"),
        (table([ODRIVE], imu={"bus": "can0", "id": 0x30}), "id 0x30 is used by 'hip' too"),
        (
            table([ODRIVE | {"ranges": {**HIP["ranges"], "torque": 40.0}}]),
            "no frame carries a torque of 40",
        ),
        (table([MOTEUS]), "moteus drives speak CAN-FD"),
        (flexible([MOTEUS, {**KNEE, "axis": "toe"}]), "damiao drives treat CAN-FD frames as errors"),
        (flexible([MOTEUS, {**MOTEUS, "axis": "toe"}]), "'toe' uses 0x100 too"),
        (
            flexible([MOTEUS], loop={"pd": "drive", "kd": 0.5}),
            "cannot use a larger share of its range for kd",
        ),
        (flexible([MOTEUS], loop={"damping": 0.5}), "a moteus damps with its whole kd of 1, not with 0.5"),
        (flexible([MOTEUS | {"registers": "int8"}]), "'int16' or 'float'"),
        (flexible([MOTEUS], rate=500_000), "500000 is slower than the arbitration rate 1000000"),
        (table([HIP, {**KNEE, "bus": "can7"}]), "no bus is called 'can7'"),
        (table([{**HIP, "sing": -1}]), "did you mean 'sign'?"),
        (table([{**HIP, "limits": {**HIP["limits"], "torque": 40.0}}]), "40 is beyond the range of 25"),
        (table([{**HIP, "ranges": {"source": "a guess"}}]), "position': is missing"),
        (table([motor("hip", 1, protocol="mit", ranges={"source": "drive"})]), "do not report their ranges"),
        (table([{**HIP, "watchdog_s": 0.2}]), "less than or equal to 0.025"),
        (table([HIP], loop={"period_s": 0.008}), "less than three periods"),
        (table([motor("hip", 1, protocol="mit", watchdog_source="")]), "cannot be read back"),
        (table([HIP], mechanism=[{"model": "leg", "axes": ["hip", "toe"]}]), "axis 'toe' has no motor"),
        (table([HIP], loop={"kp": [1.0, 2.0, 3.0]}), "has 3 values for 1 axes"),
        (table([HIP], loop={"damping": float("nan")}), "found nan"),
        (table([HIP], loop={"kp": True}), "true and false are not allowed here"),
        (table([{**HIP, "id": "two"}]), "motor 'hip'.id"),
        (table([HIP], bench={"time_scale": 0.5}), "greater than or equal to 1"),
        (table([HIP], imu={"bus": "can7", "id": 0x60}), "no bus is called 'can7'"),
        (table([HIP], imu={"bus": "can0", "id": 0x10}), "id 0x11 is used by 'hip' too"),
        (table([HIP], imu={"bus": "can0", "id": 0x7FF}), "outside 0x0 to 0x7fd"),
        (table([HIP], imu={"bus": "can0", "id": 0x60, "protocol": "x"}), "no unit is called 'x'"),
        (with_interface("socketcan", bench={"time_scale": 4.0}), "the bus 'can0' has real drives"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, content: dict, said: str) -> None:
    with pytest.raises(InputError) as caught:
        load_config(written(tmp_path, content))
    assert said in str(caught.value) and "\n" not in str(caught.value)


def test_ranges_may_be_the_drives_own(tmp_path: Path) -> None:
    assert config(tmp_path, [{**HIP, "ranges": {"source": "drive"}}]).motor[0].reads_ranges
