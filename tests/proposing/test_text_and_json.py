"""Logs with text beside their numbers, with joints named in rows, in JSON, and saved by PyTorch."""

from __future__ import annotations

import json
import pickle
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.data_helpers import data_folder
from tests.proposing.make import columns, imported, log, same, text
from workbench.core import InputError
from workbench.proposing import Answers, open_table, propose

LOG = log()


def put(folder: Path, content: str, name: str = "run.csv") -> Path:
    path = folder / name
    path.write_text(content)
    return path


@pytest.mark.parametrize("count", [1, 2, 20])
def test_columns_of_text_are_left_out_and_named(tmp_path: Path, count: int) -> None:
    words = {f"note_{k}": np.where(LOG.t < 1, "START UP", "RUN") for k in range(count)}
    plain = columns(LOG)
    data = {"mode": words["note_0"], **plain, **words}
    proposal, recording = imported(put(tmp_path, text(data)))
    same(recording, LOG, tolerance=1e-9)
    said = next(note for note in proposal.notes if "left out" in note)
    assert "mode" in said and f"note_{count - 1}" in said


def test_a_preamble_as_wide_as_the_table_is_no_row_of_it(tmp_path: Path) -> None:
    data = {"robot": np.full(len(LOG.t), "leg"), **columns(LOG)}
    above = "\n".join(",".join(["key", str(k), *["x"] * (len(data) - 2)]) for k in range(4))
    same(imported(put(tmp_path, above + "\n" + text(data)))[1], LOG, tolerance=1e-9)


@pytest.mark.parametrize("header", [True, False])
def test_joints_named_in_every_row(tmp_path: Path, header: bool) -> None:
    n = len(LOG.t)
    data = {
        "%time": (1_700_000_000_000_000_000 + np.round(LOG.t * 1e9).astype(np.int64)),
        "frame": np.full(n, ""),
    }
    data |= {"name0": np.full(n, "shin"), "name1": np.full(n, "motor")}
    for kind, values in (("position", LOG.q), ("velocity", LOG.v)):
        data |= {f"{kind}{i}": values[:, i] for i in (0, 1)}
    _, recording = imported(put(tmp_path, text(data, header=header)))
    assert recording.axes == ("shin", "motor") and recording.period == pytest.approx(0.005)
    assert np.abs(recording.position - LOG.q).max() < 1e-9


@pytest.mark.parametrize(("column", "names"), [("joint", ("hip", "knee")), ("motor_id", (3, 5))])
@pytest.mark.parametrize("late", [0.0, 0.0007])
def test_a_row_a_joint(tmp_path: Path, column: str, names: tuple, late: float) -> None:
    rows = [(t + late * i, names[i], LOG.q[k, i], LOG.v[k, i]) for k, t in enumerate(LOG.t) for i in (0, 1)]
    head = f"time,{column},position,velocity\n"
    content = head + "\n".join(f"{float(a)!r},{b},{float(c)!r},{float(d)!r}" for a, b, c, d in rows) + "\n"
    _, recording = imported(put(tmp_path, content))
    assert len(recording) == len(LOG.t) and recording.period == pytest.approx(0.005)
    assert [str(name) in axis for name, axis in zip(names, recording.axes, strict=True)] == [True, True]
    assert np.abs(recording.position - LOG.q)[5:-5].max() < (0.01 if late else 1e-9)


def test_dates_and_times_of_day_are_a_clock(tmp_path: Path) -> None:
    seconds = 86390 + LOG.t  # past midnight on the way
    cells = [f"{int(s // 3600) % 24:02d}:{int(s // 60) % 60:02d}:{s % 60:09.6f}" for s in seconds]
    data = {"date": ["2024-05-01"] * len(cells), "time": cells} | {
        k: v for k, v in columns(LOG).items() if k != "t"
    }
    same(imported(put(tmp_path, text(data)))[1], LOG, tolerance=1e-6)


def records() -> list[dict]:
    return [
        {
            "t": t,
            "state": "RUN",
            "robot": {"name": ["hip", "knee"], "position": list(LOG.q[k]), "velocity": list(LOG.v[k])},
            "cmd": {"hip": {"torque": LOG.cmd[k, 0]}, "knee": {"torque": LOG.cmd[k, 1]}},
        }
        for k, t in enumerate(LOG.t)
    ]


def in_json(kind: str) -> str:
    if kind == "list":
        return json.dumps(records())
    if kind == "lines":
        return "\n".join(json.dumps(record) for record in records())
    if kind == "within":
        return json.dumps({"kp": 60, "meta": {"robot": "leg"}, "data": {"entries": records()}, "few": [1, 2]})
    plain = {name: values.tolist() for name, values in columns(LOG).items()}
    if kind == "lists":
        return json.dumps({"robot": "leg", "log": plain})
    return json.dumps([list(plain), *map(list, zip(*plain.values(), strict=True))])


@pytest.mark.parametrize("kind", ["list", "lines", "within", "lists", "rows"])
@pytest.mark.parametrize("name", ["run.json", "run.txt"])
def test_json(tmp_path: Path, kind: str, name: str) -> None:
    proposal, recording = imported(put(tmp_path, in_json(kind), name))
    assert recording.axes == ("hip", "knee")
    assert np.abs(recording.position - LOG.q).max() < 1e-9
    assert np.abs(recording.velocity - LOG.v).max() < 1e-9
    assert recording.get("torque_command") is not None
    said = " ".join(proposal.notes)
    if kind == "within":
        assert "Not read" in said and "kp" in said and "meta" in said and "state" in said


@pytest.mark.parametrize("content", ['{"a": 1}', "[" * 5000, '{"a": [1, 2', "[1e999]", '[{"a": "b"}]'])
def test_json_that_is_no_log_is_refused(tmp_path: Path, content: str) -> None:
    with pytest.raises(InputError, match=r"JSON|holds no"):
        open_table(put(tmp_path, content, "run.json"))


class Trap:
    """Unpickled, it would make a folder."""

    def __reduce__(self) -> tuple:
        return Path.mkdir, (Path("trapped"),)


def test_tensors_are_read_and_nothing_is_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    torch = pytest.importorskip("torch")
    file = tmp_path / "run.pt"
    data = {"time": LOG.t, "dof_pos": LOG.q, "des_dof_pos": LOG.ref[:, None, :]}
    torch.save({n: torch.tensor(v) for n, v in data.items()} | {"note": "bench 3"}, file)
    proposal, recording = imported(file)
    assert np.abs(recording.position - LOG.q).max() < 1e-9
    assert np.abs(recording.signals["position_reference"] - LOG.ref).max() < 1e-9
    assert any("note" in note for note in proposal.notes)
    monkeypatch.chdir(tmp_path)
    torch.save({"time": torch.tensor(LOG.t), "trap": Trap()}, file)
    with pytest.raises(InputError, match="could run code"):
        open_table(file)
    file.write_bytes(pickle.dumps(Trap()))
    with pytest.raises(InputError, match="could run code"):
        open_table(file)
    assert not (tmp_path / "trapped").exists()


def test_without_pytorch_one_line_says_how_to_convert(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    (tmp_path / "run.pt").write_bytes(b"PK")
    with pytest.raises(InputError, match="PyTorch is not installed") as caught:
        open_table(tmp_path / "run.pt")
    assert "npz" in str(caught.value.remedy)


def test_a_measured_servo_in_json(tmp_path: Path) -> None:
    file = data_folder("bam_xl330") / "kp200_sin_sin.json"
    proposal = propose(open_table(file), Answers(units={"torque": "N*m"}, model_axes=("servo",)))
    found = proposal.description["columns"]
    assert not proposal.questions
    assert (found["time"], found["position"], found["velocity"]) == ("timestamp", ["position"], ["speed"])
    assert found["position_reference"] == ["goal_position"]
    assert "Not read: mass, length, kp, vin, motor, trajectory." in proposal.notes
