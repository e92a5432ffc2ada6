"""What is wrong ends in one line with exit code 2, and says where; what a solver has answered is kept."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from workbench_exam.__main__ import main
from workbench_exam.answers import Answer, Named, from_json, to_json

LATER = """
from pathlib import Path
from workbench_exam.answers import Answer
def solve(case):
    if not Path(__file__).with_name("mended").exists():
        raise RuntimeError("not\\nyet")
    return Answer("consistent")
"""


@pytest.fixture
def ask(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    """Runs the command: exit code and the line that it ends with."""

    def run(*arguments: object) -> tuple[int, str]:
        monkeypatch.setattr("sys.argv", ["workbench-exam", *map(str, arguments)])
        code = 0
        try:
            main()
        except SystemExit as end:
            code = int(end.code or 0)
        said = capsys.readouterr()
        assert "Traceback" not in said.err and said.err.count("\n") <= 1, said.err
        return code, said.err or said.out

    return run


@pytest.mark.parametrize(
    ("named", "says"),
    [
        ("x", "named: a list"),
        (["x"], r"named\[0\]: an object with effect and place"),
        ([{"effect": [1]}], "effect: '\\[1\\]' is not in the vocabulary"),
        ([{"effect": "torque_bias", "place": "nose"}], "place: 'nose' is no drive; there are yaw, lift"),
        ([{"effect": "payload_mass", "values": [1]}], "values: an object"),
        ([{"effect": "payload_mass", "values": {"mass": 0.3}}], 'mass: an object like {"value"'),
        ([{"effect": "payload_mass", "values": {"mass": {"value": "a"}}}], "mass: a number, not 'a'"),
        (
            [{"effect": "payload_mass", "values": {"mass": {"value": 1, "interval": [1]}}}],
            "mass: interval: two numbers",
        ),
        ([{"effect": "payload_mass", "probability": "high"}], "probability: a number, not 'high'"),
        ([{"effect": "payload_mass", "also": [{}]}], "also: effect: 'None'"),
    ],
)
def test_a_wrong_name_says_where(named: object, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        from_json({"verdict": "missing_effect", "named": named}, drives=("yaw", "lift"))


def test_numbers_of_numpy_are_numbers() -> None:
    value = np.float32(0.5), np.float32(0.25), np.float64(0.75)
    said = Answer("missing_effect", (Named("payload_mass", None, {"mass": value}, np.float32(0.5)),))  # type: ignore[arg-type]
    read = from_json(json.loads(json.dumps(to_json(said)))).named[0]
    assert read.values["mass"] == (0.5, 0.25, 0.75) and read.probability == 0.5


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (None, "no such Python file"),
        ("def solve(case", "does not load: SyntaxError"),
        ("import nothing_like_it", r"does not load: ModuleNotFoundError.*pip install"),
        ("x = 1", "has no function solve"),
    ],
)
def test_a_solver_that_does_not_load_says_why(text, says: str, case: Path, tmp_path: Path, ask) -> None:
    solver = tmp_path / "mine.py"
    if text is not None:
        solver.write_text(text)
    code, line = ask("run", solver, case.parent, "-o", tmp_path / "out")
    assert code == 2 and re.search(says, line), line


def test_a_solver_that_raises_is_asked_again_when_it_is_mended(case: Path, tmp_path: Path, ask) -> None:
    (tmp_path / "mine.py").write_text(LATER)
    out = tmp_path / "out"
    code, line = ask("run", tmp_path / "mine.py", case.parent, "-o", out)
    assert code == 2 and "failed in 1 of 1 cases, first in case-000" in line
    assert json.loads((out / "case-000.json").read_text())["failed"] == "RuntimeError: not yet"
    assert "| out (1 failed) |" in ask("score", case.parent, out)[1]
    (tmp_path / "mended").touch()
    assert ask("run", tmp_path / "mine.py", case.parent, "-o", out)[0] == 0
    assert "failed" not in json.loads((out / "case-000.json").read_text())
    (tmp_path / "mended").unlink()  # what is answered is not asked again
    assert ask("run", tmp_path / "mine.py", case.parent, "-o", out)[0] == 0


def test_what_is_no_answer_to_a_case_is_not_marked(case: Path, tmp_path: Path, ask) -> None:
    file = tmp_path / "case-000.json"
    for text, says in (
        ("{", f"{file}: no JSON"),
        ("[]", f"{file}: an object with verdict"),
        ('{"verdict": ["consistent"]}', f"{file}: verdict: one of consistent"),
        ('{"verdict": "consistent", "processor_seconds": "long"}', "processor_seconds: a number"),
    ):
        file.write_text(text)
        code, line = ask("score", case.parent, tmp_path)
        assert code == 2 and says in line, line
    file.write_text('{"verdict": "consistent"}')
    assert ask("score", case.parent, tmp_path)[0] == 0
    assert ask("score", case.parent, tmp_path, "--key", "guess") == (
        2,
        "case-000: this key does not open it\n",
    )
    file.rename(tmp_path / "case-099.json")
    code, line = ask("score", case.parent, tmp_path)
    assert code == 2 and "case-099.json: no case" in line
    code, line = ask("score", case.parent, tmp_path / "nowhere")
    assert code == 2 and "no answers; ask a solver" in line


def test_a_damaged_case_is_named(case: Path, tmp_path: Path, ask) -> None:
    (tmp_path / "mine.py").write_text(LATER)
    for name, text in (("slow.csv", ""), ("slow.csv", "time\n"), ("case.json", "{"), ("case.json", "{}")):
        folder = tmp_path / "cases" / "case-000"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(case, folder)
        (folder / name).write_text(text)
        code, line = ask("run", tmp_path / "mine.py", folder.parent, "-o", tmp_path / "out")
        assert code == 2 and line.startswith(f"{folder}: damaged"), line


def test_cases_of_two_sets_are_not_mixed(case: Path, ask) -> None:
    assert ask("make", case.parent, "--count", 1, "--jobs", 1)[0] == 0
    code, line = ask("make", case.parent, "--count", 1, "--jobs", 1, "--seed", 6)
    assert code == 2 and "another seed or count" in line
    code, line = ask("make", case.parent, "--count", 1, "--jobs", 1, "--key", "other")
    assert code == 2 and "does not open" in line


@pytest.mark.parametrize("count", ["0", "-1"])
def test_no_cases_are_refused(count: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["workbench-exam", "make", str(tmp_path), "--count", count])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 2
