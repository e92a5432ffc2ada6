"""The package as somebody without a clone gets it: built, installed in empty environments, used.

Each Python that `pyproject.toml` names and this machine has is asked; the first of them installs the sdist,
the others the wheel. One that is not here is named: it was not tested.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).parent.parent
#: A robot and a log of somebody who has no clone.
OWN = ("arm.xml", "sweep.csv")
#: What a new user does first; each ends with exit code 0, in a folder that has only `OWN`.
COMMANDS = (
    ("--version",),
    ("check", "leg", "--quiet"),
    ("normalize", "leg", "-o", "leg.xml", "--quiet"),
    ("import", "sweep.csv", "--model", "arm.xml", "-o", "sweep.toml", "--quiet"),
    ("compare", "arm.xml", "sweep.toml", "--html", "report.html", "--quiet"),
)

ASKED = "import venv, ensurepip, sys; print(*sys.version_info[:2], sep='.')"


def main() -> None:
    """Builds, installs and tries; ends with 1 where something failed or nothing could be tried."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", help="this Python alone, such as 3.12")
    only = parser.parse_args().only
    stated = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["classifiers"]
    versions = [
        v for each in stated if (v := each.rpartition(" :: ")[2]).startswith("3.") and only in (None, v)
    ]
    pythons = {version: path for version in versions if (path := found(version))}
    for version in sorted(set(versions) - set(pythons)):
        print(f"Python {version}: not on this machine, not tested", flush=True)
    if not pythons:
        sys.exit("failed: no Python to install the package in")
    with tempfile.TemporaryDirectory(prefix="packages-") as name:
        folder = Path(name)
        run([sys.executable, "-m", "hatchling", "build", "-d", str(folder / "dist")], ROOT)
        [wheel], [sdist] = ((folder / "dist").glob(pattern) for pattern in ("*.whl", "*.tar.gz"))
        for index, (version, python) in enumerate(pythons.items()):
            begin, package = time.monotonic(), wheel if index else sdist
            tried(python, package, folder / version)
            print(f"Python {version}: {package.name} works, {time.monotonic() - begin:.0f} s", flush=True)
            shutil.rmtree(folder / version)


def found(version: str) -> Path | None:
    """The Python of a version on this machine, where it runs and makes environments; else None."""
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    named = [
        shutil.which(f"python{version}"),
        *map(str, sorted(pyenv.glob(f"{version}.*/bin/python"), reverse=True)),
    ]
    for path in filter(None, named):
        asked = subprocess.run([path, "-c", ASKED],
                               capture_output=True, text=True)  # fmt: skip
        if asked.returncode == 0 and asked.stdout.strip() == version:
            return Path(path)
    return None


def tried(python: Path, package: Path, folder: Path) -> None:
    """Installs a package and its needs, at the versions of the lock file, and runs what a new user runs."""
    work = folder / "work"
    work.mkdir(parents=True)
    run([str(python), "-m", "venv", str(folder / "env")], work)
    pip = [str(folder / "env/bin/python"), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    run([*pip, "-c", str(ROOT / "requirements.lock"), str(package)], work)
    for name in OWN:
        shutil.copy(ROOT / "docs/tutorial" / name, work)
    for words in COMMANDS:
        run([str(folder / "env/bin/workbench"), *words], work)


def run(words: list[str], folder: Path) -> None:
    """Runs a command without what this environment sets for Python; ends the whole where it fails."""
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "VIRTUAL_ENV"))}
    done = subprocess.run(words, cwd=folder, env=clean, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"failed: {' '.join(words)}\n{done.stdout[-2000:]}{done.stderr[-4000:]}")


if __name__ == "__main__":
    main()
