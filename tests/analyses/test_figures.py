"""README and results state what the table of figures has, and `make figures` finds it in what runs."""

from __future__ import annotations

import json
from pathlib import Path

import figure_files
import figure_table
import figures
import numpy as np
import pytest
from figure_table import NUMBER, NotFoundError, filled, measured, stated, table_rows
from matplotlib.image import imsave

ROOT = Path(__file__).resolve().parents[2]
RESULTS = {
    name: (ROOT / name).read_text(encoding="utf-8").split("# Results\n", 1)[1].split("\n## ")[0]
    for name in ("README.md", "docs/results.md")
}


@pytest.mark.parametrize("page", RESULTS)
def test_every_row_of_the_results_is_a_figure_of_the_table(page: str) -> None:
    stands = [(f, s) for f in figure_table.figures() for s in f.get("stands", ()) if s["file"] == page]
    rows = list(table_rows(RESULTS[page]))[2:]
    assert len(rows) == len(stands)
    for what, result, theirs, _ in rows:
        [(figure, stand)] = [(f, s) for f, s in stands if what.startswith(s["row"])]
        assert result == filled(figure, stand["text"]), what
        fixed = set(figure.get("fixed", ()))
        peer = stand.get("peer")
        assert theirs == filled(figure, peer) if peer else set(NUMBER.findall(theirs)) <= fixed, what
        assert set(NUMBER.findall(what)) <= fixed, what
        nameless = (stand["text"] + (peer or "")).format_map({v["name"]: "" for v in figure["values"]})
        assert set(NUMBER.findall(nameless)) <= fixed, f"{what}: a number that no command makes"


def test_rows_of_long_studies_are_those_of_their_pages() -> None:
    """What takes hours is not run here: the README agrees with the page that the study wrote."""
    values = {f["id"]: {v["name"]: v["value"] for v in f.get("values", ())} for f in figure_table.figures()}

    def row(page: str, first: str) -> list[str]:
        rows = table_rows((ROOT / page).read_text(encoding="utf-8"))
        return next([c.split(" ±")[0].removesuffix(" %") for c in r] for r in rows if r[0].startswith(first))

    gait = values["gait"]
    stride = [gait[f"stride_{who}"] for who in ("kin_only", "act", "full", "found", "again")]
    assert row("docs/transfer.md", "stride frequency [%]")[1:6] == stride
    chirp, full = values["chirp_clean"], row("docs/transfer-leg.md", "S3N-Full")
    assert full[-2:] == [chirp["position"], chirp["torque"]]
    exam = values["exam"]
    assert f"{exam['single']} of {exam['singles']}" in row("docs/diagnosis.md", "seed 17, all 238")
    sysid = values["sysid"]
    for which in ("right", "wrong"):
        ratio = float(sysid[f"ours_{which}"]) / float(sysid[f"theirs_{which}"])
        told = row("docs/benchmarks.md", f"error on held-out motion, structure {which}")[2]
        assert float(told) == pytest.approx(ratio, abs=0.002), which
    assert row("docs/benchmarks.md", "CPU time")[2] == f"{sysid['least']} to {sysid['most']}"


def test_every_value_stands_somewhere_and_every_file_is_there() -> None:
    known = figure_table.figures()
    assert len({f["id"] for f in known}) == len(known)
    for figure in known:
        text = "".join(s["text"] + s.get("peer", "") for s in figure.get("stands", ()))
        names = [v["name"] for v in figure.get("values", ())]
        assert len(set(names)) == len(names) and all(f"{{{n}}}" in text for n in names), figure["id"]
        for command in figure["commands"]:
            program, script = command.split()[:2]
            assert program == "workbench" or (program == "python" and (ROOT / script).is_file()), command
        for file in (*figure.get("pages", ()), *(p["file"] for p in figure.get("pictures", ()))):
            assert (ROOT / file).exists(), file


def test_a_number_is_found_in_json_tables_and_text(tmp_path: Path) -> None:
    made = {"found": [{"axis": "hip", "x": 3.0}, {"axis": "knee", "x": 4.0}], "noise": 2.0}
    (tmp_path / "a.json").write_text(json.dumps(made))
    (tmp_path / "t.md").write_text(
        "| kind | good |\n|---|---|\n| a, b | 3 of 4 |\n| c |  |\n| S3N | 2.5 ± 0.3 |\n"
    )
    value = {"file": "a.json", "json": "found.axis=knee.x", "scale": 10, "over": {"json": "noise"}}
    assert measured(value, tmp_path, "") == 20.0
    cell = {"file": "t.md", "rows": ["a, b", "c"], "column": "good", "take": 1}
    assert measured(cell, tmp_path, "") == 4.0
    of_spread = {"file": "t.md", "row": "S3N", "column": "good", "take": 1}
    assert measured(of_spread, tmp_path, "") == 0.3
    assert measured({"pattern": r"ratio \| (\d+)"}, tmp_path, "| ratio | 7 |") == 7.0
    for lost in (
        {"file": "t.md", "row": "d", "column": "good"},
        {"pattern": "x(y)"},
        {**value, "json": "found.5.x"},
    ):
        with pytest.raises(NotFoundError):
            measured(lost, tmp_path, "")


@pytest.fixture
def small(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A checkout with one figure of each kind."""
    (tmp_path / "page.md").write_text("| what | result |\n|---|---|\n| Steps of S3N (1 leg) | 1.50, 8 |\n")
    (tmp_path / "made.md").write_text("old, 3 s\n")
    (tmp_path / "figures.toml").write_text(
        r"""[[figure]]
id = "one"
commands = ["echo '{{\"a\": 1.512, \"b\": 9}}' > {out}/a.json; echo new, 4 s > made.md"]
stands = [{file = "page.md", row = "Steps of S3N", text = "{a}, {b}"}]
values = [
  {name = "a", value = "1.50", within = 0.02, file = "a.json", json = "a"},
  {name = "b", value = "8", within = 0, file = "a.json", json = "b"},
]
pages = ["made.md"]
ignore = ", \\d s"
[[figure]]
id = "two"
needs = ["nothing_such"]
commands = ["false"]
[[figure]]
id = "slow"
long = true
commands = ["echo why >&2; false"]
"""
    )
    for module in (figures, figure_table, figure_files):
        monkeypatch.setattr(module, "ROOT", tmp_path)
    for module in (figures, figure_table):
        monkeypatch.setattr(module, "TABLE", tmp_path / "figures.toml")
    return tmp_path


def test_what_changed_is_said_and_nothing_is_touched(small: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert figures.main(["--data", str(small)]) == 1
    said = capsys.readouterr().out
    lines = [" ".join(line.replace("│", " ").replace("┃", " ").split()) for line in said.splitlines()]
    assert "one a 1.50 1.51 within noise" in lines and "one b 8 9 ! changed" in lines
    assert "one made.md old new ! changed" in lines
    assert "left out: needs nothing_such" in said and "slow" not in said
    assert "1.50, 8" in (small / "page.md").read_text() and (small / "made.md").read_text() == "old, 3 s\n"


def test_what_changed_is_written_where_that_is_asked(small: Path) -> None:
    figures.main(["--data", str(small), "--only", "one", "--write"])
    assert stated({"file": "", "row": "Steps"}, (small / "page.md").read_text())[1] == "1.51, 9"
    assert (small / "made.md").read_text() == "new, 4 s\n"
    assert figures.main(["--data", str(small), "--only", "one"]) == 0


def test_a_command_that_fails_says_why(small: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert figures.main(["--data", str(small), "--only", "slow"]) == 1
    assert "why" in capsys.readouterr().out


def test_pictures_differ_where_an_eye_would_see_it(tmp_path: Path) -> None:
    white = np.ones((200, 300, 3))
    imsave(tmp_path / "a.png", white)
    imsave(tmp_path / "b.png", np.ones((400, 600, 3)))
    white[:, :150] = 0.0
    imsave(tmp_path / "c.png", white)
    assert figure_files.difference(tmp_path / "a.png", tmp_path / "b.png") == 0.0
    assert figure_files.difference(tmp_path / "a.png", tmp_path / "c.png") == pytest.approx(0.5, abs=0.02)
