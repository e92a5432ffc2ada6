"""Full disks, interrupts and kills: what was there stays whole, and nothing half-written is left."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import pytest

from workbench.core import InputError
from workbench.core.files import together, write_all, write_whole
from workbench.core.unfinished import READY, finish


def pair(folder: Path) -> dict[Path, str]:
    """Two files as they were before."""
    old = {folder / "run.toml": "old description", folder / "run.csv": "old table"}
    write_all(dict(old))
    return old


def kept(old: dict[Path, str], folder: Path) -> None:
    assert {p: p.read_text() for p in folder.iterdir()} == old


@pytest.mark.parametrize("at", [1, 2])
def test_a_full_disk_leaves_what_was_there(at: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old, calls = pair(tmp_path), list[int]()

    def full(handle: int) -> None:
        calls.append(handle)
        if len(calls) == at:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(InputError, match=r"run\.toml: cannot write: No space left on device"):
        write_all(dict.fromkeys(old, "new"), force=True)
    kept(old, tmp_path)


def test_a_limit_on_the_size_of_files(tmp_path: Path) -> None:
    old = pair(tmp_path)
    script = f"""
        import resource, signal
        from pathlib import Path
        from workbench.core import InputError
        from workbench.core.files import write_all
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
        try:
            folder = Path({str(tmp_path)!r})
            write_all({{folder / n: "x" * 10_000 for n in ("run.toml", "run.csv")}}, force=True)
        except InputError as error:
            print(error)
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], capture_output=True, text=True)
    assert "cannot write: File too large" in done.stdout, done.stderr
    kept(old, tmp_path)


def test_one_that_exists_keeps_the_others_from_being_written(tmp_path: Path) -> None:
    (tmp_path / "b").write_text("old")
    with pytest.raises(InputError, match="exists"):
        write_all({tmp_path / "a": "new", tmp_path / "b": "new"})
    assert [p.name for p in tmp_path.iterdir()] == ["b"]


@pytest.mark.parametrize("failing", ["exists", "twice", "code"])
def test_a_block_whose_end_is_not_reached_writes_nothing(failing: str, tmp_path: Path) -> None:
    new, old = tmp_path / "new" / "deep", pair(tmp_path)
    with pytest.raises((InputError, KeyError)), together():
        write_all({new / "a": "1", new / "b": "2"})
        write_whole(tmp_path / "run.csv", "new", force=True)
        if failing == "exists":
            write_whole(tmp_path / "run.toml", "new")
        if failing == "twice":
            write_whole(new / "a", "3", force=True)
        raise KeyError
    kept(old, tmp_path)


def test_a_block_is_placed_at_the_end_of_the_outermost(tmp_path: Path) -> None:
    with together():
        with together():
            write_all({tmp_path / "a": "1", tmp_path / "new" / "b": "2"})
        with suppress(InputError):
            write_all({tmp_path / "c": "1", tmp_path / "a": "again"}, force=True)
        assert not (tmp_path / "a").exists() and not (tmp_path / "new" / "b").exists()
        write_whole(tmp_path / "d", "4")
    texts = {str(p.relative_to(tmp_path)): p.read_text() for p in tmp_path.rglob("*") if p.is_file()}
    assert texts == {"a": "1", "new/b": "2", "d": "4"}, "what was refused inside is left out, whole"


@pytest.fixture
def interruptible() -> Iterator[None]:
    """A process that was started in the background ignores interrupts, and so would the test."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
def test_an_interrupt_waits_until_all_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old = pair(tmp_path)
    monkeypatch.setattr(os, "fsync", lambda handle: os.kill(os.getpid(), signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        write_all(dict.fromkeys(old, "new"), force=True)
    kept(dict.fromkeys(old, "new"), tmp_path)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_killed_process_leaves_one_named_folder(tmp_path: Path) -> None:
    old = pair(tmp_path)
    script = f"""
        import os, signal
        from pathlib import Path
        from workbench.core.files import write_all
        os.fsync = lambda handle: os.kill(os.getpid(), signal.SIGKILL)
        write_all({{Path({str(tmp_path)!r}) / n: "new" for n in ("run.toml", "run.csv")}}, force=True)
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], capture_output=True)
    assert done.returncode == -signal.SIGKILL
    (left,) = [p for p in tmp_path.iterdir() if p not in old]
    assert left.name.startswith(".run.toml.") and left.name.endswith(".part")
    assert {p: p.read_text() for p in old} == old
    write_all(dict.fromkeys(old, "new"), force=True)
    assert (tmp_path / "run.csv").read_text() == "new"


@pytest.mark.parametrize("at", [0, 1, 2])
@pytest.mark.parametrize("next_one", ["reads", "writes", "writes another"])
def test_killed_between_two_renames_the_next_completes_them(at: int, next_one: str, tmp_path: Path) -> None:
    old = pair(tmp_path)
    script = f"""
        import os, signal
        from pathlib import Path
        from workbench.core.files import write_all
        calls, replace = [], os.replace
        def dying(*words):
            if len(calls) == {at}:
                os.kill(os.getpid(), signal.SIGKILL)
            calls.append(words)
            replace(*words)
        os.replace = dying
        os.unlink = os.rmdir = lambda *words, **more: os.kill(os.getpid(), signal.SIGKILL)
        write_all({{Path({str(tmp_path)!r}) / n: "new" for n in ("run.toml", "run.csv")}}, force=True)
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], capture_output=True)
    assert done.returncode == -signal.SIGKILL
    assert [p.read_text() for p in old] == (["new"] * at + list(old.values())[at:])[:2]
    new = dict.fromkeys(old, "new")
    if next_one == "reads":
        finish(tmp_path)
    else:
        others = {tmp_path / f"{k}": "other" for k in range(2)} if next_one == "writes another" else new
        write_all(dict(others), force=True)
        new |= others
    kept(new, tmp_path)


def test_a_list_that_leads_out_of_its_folder_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "own" / READY).mkdir(parents=True)
    (tmp_path / "own" / READY / "0").write_text("new")
    for names in ('["../out"]', '["/etc/x"]', "[1]", "no list", '[""]'):
        (tmp_path / "own" / READY / "names.json").write_text(names)
        with pytest.raises(InputError, match=r"\.unfinished\.part: .* cannot be placed"):
            finish(tmp_path / "own")
    assert [p.name for p in tmp_path.iterdir()] == ["own"] and (tmp_path / "own" / READY / "0").exists()


def test_readers_wait_for_a_writer_that_is_at_it(tmp_path: Path) -> None:
    def at_work() -> None:
        for k in range(40):
            write_all({tmp_path / "a": f"{k}", tmp_path / "b": f"{k}"}, force=True)

    write_all({tmp_path / "a": "-", tmp_path / "b": "-"})
    with ThreadPoolExecutor(3) as pool:
        jobs = [pool.submit(at_work), pool.submit(at_work)]
        while not all(job.done() for job in jobs):
            finish(tmp_path)
        for job in jobs:
            job.result()
    assert (tmp_path / "a").read_text() == (tmp_path / "b").read_text() == "39"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a", "b"]


def test_modes_are_those_of_any_new_file(tmp_path: Path) -> None:
    (tmp_path / "plain").write_text("x")
    write_whole(tmp_path / "made", "x")
    assert (tmp_path / "made").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_an_interrupt_ends_a_command_with_130(tmp_path: Path) -> None:
    script = """
        import os, signal, typer
        signal.signal(signal.SIGINT, signal.default_int_handler)
        typer.Typer.__call__ = lambda self: os.kill(os.getpid(), signal.SIGINT)
        from workbench.cli import main
        main()
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script)], cwd=tmp_path, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr, list(tmp_path.iterdir())) == (130, "interrupted\n", [])
