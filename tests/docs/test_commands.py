"""Every command in the documentation runs, in order, and prints what the page shows.

In a ``console`` block a line that begins with ``$`` is run; ``# exit 1`` behind it says how it ends. Lines
below it are found in what it prints, spaces and line breaks aside; ``…`` stands for anything, and numbers
that were measured may differ a little (`NEAR`). A ``toml NAME``
or ``xml NAME`` block is written to that file first. All blocks of a page share one empty folder. A
``sh`` block takes hardware, a browser or hours: its commands and options have to be there. What imports
``workbench`` in a ``python`` block runs.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from typer.main import get_command

from tests.cli import here
from workbench.cli.app import app
from workbench.core.paths import models_folder
from workbench.recordings import save_recording
from workbench.rigs import VirtualLeg, chirp

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
BLOCK = re.compile(r"^```(?P<kind>\w+)(?: (?P<name>\S+))?\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
#: A number with a decimal point is measured; it may differ by this part of itself.
MEASURED, NEAR = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.])"), 0.1
WIDTHS = {"tutorial.md": 80}


def blocks(page: Path) -> list[tuple[str, str | None, str]]:
    found = [(b["kind"], b["name"], b["text"]) for b in BLOCK.finditer(page.read_text(encoding="utf-8"))]
    return [b for b in found if b[0] == "console" or (b[0] in ("toml", "xml", "python") and b[1])]


@pytest.mark.parametrize(
    "page", [p for p in PAGES if any(b[0] == "console" for b in blocks(p))], ids=lambda p: p.name
)
def test_commands_of_a_page_run_in_order(page: Path, tmp_path: Path) -> None:
    for folder in ("docs/tutorial", "examples"):  # as in a clone
        shutil.copytree(ROOT / folder, tmp_path / folder)
    shutil.copytree(ROOT / "docs/tutorial", tmp_path / "tutorial")  # as the tutorial's first step
    for kind, name, text in blocks(page):
        if kind != "console":
            assert name is not None
            (tmp_path / name).write_text(text, encoding="utf-8")
            continue
        for step in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
            command, _, shown = step.partition("\n")
            run(command, shown, tmp_path, WIDTHS.get(page.name, 120))


def shell(command: str, folder: Path, columns: int) -> subprocess.CompletedProcess[str]:
    """What a line does in a shell; a command of ours runs in this process, once its patterns are expanded."""
    # documented commands are ours: the shell expands their patterns as a reader's does
    whole = not command.startswith("workbench ") or any(sign in command for sign in "|<>&;")
    script = command if whole else f"printf '%s\\0' {command}"
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    env = {**os.environ, "PATH": path, "COLUMNS": str(columns), "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(["bash", "-c", script], cwd=folder, env=env, capture_output=True, text=True)
    return done if whole else here.run(*done.stdout.split("\0")[1:-1], cwd=folder, columns=columns)


def run(command: str, shown: str, folder: Path, columns: int = 120) -> None:
    done = shell(command, folder, columns)
    expected = re.search(r"# exit (\d)", command)
    said = f"{command}\n{done.stdout}\n{done.stderr}"
    assert done.returncode == (int(expected[1]) if expected else 0), said
    printed = " ".join((done.stdout + done.stderr).split())
    wanted = [" ".join(line.split()) for line in shown.splitlines() if line.strip()]
    pattern = " ?".join(re.escape(line).replace("…", ".*?") for line in wanted)
    numbers = MEASURED.findall(pattern.replace("\\.", "."))
    pattern = MEASURED.sub(r"(\\d+(?:\\.\\d+)?)", pattern.replace("\\.", "."))
    found = re.search(pattern, printed)
    assert found, f"the page shows:\n{shown}\nbut it is:\n{said}"
    for wanted_number, number in zip(numbers, found.groups(), strict=True):
        assert float(number) == pytest.approx(float(wanted_number), rel=NEAR, abs=1e-3), said


def test_a_number_may_differ_a_little_and_no_more(tmp_path: Path) -> None:
    run("echo error 0.0444, 98 %", "error 0.0431, 98 %", tmp_path)
    for shown in ("error 0.0331, 98 %", "error 0.0444, 97 %", "another 0.0444, 98 %"):
        with pytest.raises(AssertionError):
            run("echo error 0.0444, 98 %", shown, tmp_path)


def test_the_tutorial_leaves_nothing_out() -> None:
    sessions = [text for kind, _, text in blocks(ROOT / "docs" / "tutorial.md") if kind == "console"]
    assert sum(text.count("\n") for text in sessions) > 80 and not any("…" in text for text in sessions)


def test_names_in_the_pages_exist() -> None:
    """Links lead to files, and shipped models that a page names are there."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text):
            assert (page.parent / target).exists(), f"{page.name}: {target}"
    listed = re.search(r"of a shipped one \((.*?)\)", Path(ROOT / "docs/commands.md").read_text(), re.DOTALL)
    assert listed
    shipped = {file.stem for file in models_folder().glob("*.toml")}
    assert set(re.findall(r"`(\w+)`", listed[1])) == shipped


def words_of(kind: str) -> list[tuple[str, list[str]]]:
    """Page and words of each line of all blocks of a kind, without what only a reader sees."""
    found = []
    for page in PAGES:
        for block in BLOCK.finditer(page.read_text(encoding="utf-8")):
            for line in block["text"].replace("\\\n", " ").splitlines() if block["kind"] == kind else ():
                plain = re.sub(r"<[^>]*>", "X", line).replace("[", " ").replace("]", " ").rstrip("& ")
                for command in plain.split("&&"):
                    if words := shlex.split(command, comments=True):
                        found.append((page.name, words))
    return found


def test_what_no_test_runs_names_commands_that_exist() -> None:
    checked = 0
    for page, (program, *words) in words_of("sh"):
        if program == "python":
            assert (ROOT / words[0]).is_file(), f"{page}: {words[0]}"
        if program != "workbench":
            continue
        command: Any = get_command(app)
        while words and words[0] in getattr(command, "commands", {}):
            command = command.commands[words.pop(0)]
        assert not getattr(command, "commands", {}) or not words or words[0].startswith("-"), (
            f"{page}: {words}"
        )
        known = {o for p in command.params for o in (*p.opts, *p.secondary_opts)} | {"-h", "--help"}
        asked = {word.split("=")[0] for word in words if re.match(r"--?[a-z]", word)}
        assert asked <= known, f"{page}: {asked - known}"
        checked += 1
    assert checked > 5


def test_python_on_the_pages_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = VirtualLeg(seed=1).run([chirp("knee", duration=1.0)])
    save_recording(made[0], tmp_path / "data" / "chirp.toml")
    monkeypatch.chdir(tmp_path)
    blocks = [b["text"] for p in PAGES for b in BLOCK.finditer(p.read_text("utf-8")) if b["kind"] == "python"]
    for text in blocks:
        if text.startswith("import workbench"):
            names: dict[str, Any] = {}
            exec(text, names)  # the documentation is ours
            assert names["comparison"].consistent and names["diagnosis"].verdict == "consistent"
    assert any(text.startswith("import workbench") for text in blocks)
