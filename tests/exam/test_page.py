"""The tables of docs/benchmark.md are what the marks in exam/ say."""

import json
from pathlib import Path

import pytest
from workbench_exam.__main__ import main
from workbench_exam.table import lines_of, read_lines, table

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "benchmark.md").read_text("utf-8").splitlines()
MAKEFILE = (ROOT / "Makefile").read_text("utf-8").splitlines()
MARKS = read_lines(ROOT / "exam" / "open-marks.jsonl")
#: Marks of the answers that were given before a case was seen were not kept: its row stands as it was.
FIRST = "| workbench, first answers |"


#: The page's tables, in its order.
TABLES = (
    {name: marks[:24] for name, marks in MARKS.items()},
    {name: marks for name, marks in MARKS.items() if len(marks) == 60},
    read_lines(ROOT / "exam" / "fresh-marks.jsonl"),
    read_lines(ROOT / "exam" / "fresh-58-marks.jsonl"),
)


@pytest.mark.parametrize("number", range(len(TABLES)))
def test_a_table_is_what_the_marks_say(number: int) -> None:
    head, rule, *rows = table(TABLES[number]).splitlines()
    starts = [k for k, line in enumerate(PAGE) if line.startswith("| solver | cases right |")]
    start = starts[number]
    assert len(starts) == len(TABLES) and PAGE[start] == head
    end = next(k for k in range(start, len(PAGE)) if not PAGE[k].startswith("|"))
    assert PAGE[start + 1] == rule
    shown = [line for line in PAGE[start + 2 : end] if not line.startswith(FIRST)]
    assert shown == rows and len(shown) == end - start - 2 - (number == 0)


def test_every_baseline_answered_the_same_cases() -> None:
    files = (ROOT / "exam" / "baselines").glob("*.py")
    solvers = {file.stem for file in files if "\ndef solve(" in file.read_text("utf-8")}
    listed = next(line for line in MAKEFILE if line.startswith("BASELINES := ")).split()[2:]
    assert list(MARKS) == [*listed, "workbench"] and set(listed) == solvers
    for name, marks in MARKS.items():
        # this project's own may have the first ones only, and its row says so
        assert [m["case"] for m in marks] == [f"case-{k:03d}" for k in range(60)][: max(len(marks), 8)], name
        assert len(marks) in (24, 60) or name == "workbench"
        assert not any("failed" in m for m in marks), name


def test_marks_are_the_same_when_read_back(tmp_path: Path) -> None:
    file = tmp_path / "marks.jsonl"
    file.write_text(lines_of(MARKS))
    assert read_lines(file) == MARKS
    file.write_text(json.dumps({"case": "case-000"}) + "\n")
    with pytest.raises(ValueError, match=r"marks.jsonl:1: no mark of a solver"):
        read_lines(file)


def test_the_command_on_the_page_prints_its_first_table(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    command = "workbench-exam table exam/open-marks.jsonl --first 24"
    assert any(f"`{command}`" in line for line in PAGE)
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr("sys.argv", command.split())
    main()
    assert capsys.readouterr().out.strip() == table(TABLES[0])
