"""What the code imports is what the package declares and what the lock pins."""

import ast
import os
import re
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path

from workbench.core.version import VERSION

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
#: Modules whose distribution goes by another name.
DISTRIBUTIONS = {
    "can": "python-can",
    "mcap_ros2": "mcap-ros2-support",
    "mujoco_warp": "mujoco-warp",
    "pinocchio": "pin",
    "pydrake": "drake",
    "google": "protobuf",
    "mpl_toolkits": "matplotlib",
    "rerun": "rerun-sdk",
    "rsl_rl": "rsl-rl-lib",
    "tomli_w": "tomli-w",
    "warp": "warp-lang",
    "yaml": "pyyaml",
}
EXTRA = PROJECT["optional-dependencies"]["training"]
PAGES = PROJECT["optional-dependencies"]["ui"]
CLUSTER = PROJECT["optional-dependencies"]["ray"]
RERUN = PROJECT["optional-dependencies"]["rerun"]
NOTEBOOKS = PROJECT["optional-dependencies"]["notebook"]
GYM = PROJECT["optional-dependencies"]["gym"]
#: What some commands use where it is there.
OPTIONAL = [*PROJECT["optional-dependencies"]["logs"], *PAGES, *CLUSTER, *RERUN, *NOTEBOOKS, *GYM]


def third_party(folder: str, *, guarded: bool = True) -> set[str]:
    """Distributions that a folder imports; without `guarded`, only those that it cannot do without."""
    own = {"workbench", "tests", *sys.stdlib_module_names}
    # scripts find what lies beside them
    beside = ("benchmarks", "analyses", "exam", "exam/baselines")
    own |= {entry.stem for scripts in beside for entry in (ROOT / scripts).iterdir()}
    files = (ROOT / folder).rglob("*.py")
    modules = {module.split(".")[0] for file in files for module in imported(file, guarded)} - own
    return {DISTRIBUTIONS.get(module, module) for module in modules}


def imported(file: Path, guarded: bool) -> Iterator[str]:
    tree = ast.parse(file.read_text())
    caught = (
        set() if guarded else {id(node) for attempt in ast.walk(tree) for node in _missing_is_caught(attempt)}
    )
    for node in ast.walk(tree):
        if id(node) in caught:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module or ""


def _missing_is_caught(attempt: ast.AST) -> list[ast.stmt]:
    if not isinstance(attempt, ast.Try):
        return []
    handlers = [handler.type for handler in attempt.handlers]
    return attempt.body if any(isinstance(h, ast.Name) and h.id == "ImportError" for h in handlers) else []


def names(requirements: list[str]) -> set[str]:
    return {re.split(r"[\[<>=!~; ]", line)[0].lower().replace("_", "-") for line in requirements}


def test_dependencies_are_what_the_package_imports() -> None:
    needed = names(PROJECT["dependencies"]) | names(EXTRA)
    assert needed == third_party("workbench") - names(OPTIONAL)
    for folder in (ROOT / "workbench").iterdir():
        if folder.is_dir() and folder.name not in ("training", "bundle"):
            assert not third_party(f"workbench/{folder.name}", guarded=False) & names(EXTRA), folder.name
        if folder.is_dir() and folder.name != "ui":
            assert not third_party(f"workbench/{folder.name}") & names(PAGES), folder.name


def test_tests_and_benchmarks_need_no_more_than_the_dev_extra() -> None:
    declared = names([*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["dev"], *EXTRA, *OPTIONAL])
    assert third_party("tests") | third_party("benchmarks") <= declared


def test_the_lock_pins_every_requirement_and_names_no_host() -> None:
    text = "".join((ROOT / f"requirements{part}.lock").read_text() for part in ("", "-training", "-ray"))
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    assert all(re.fullmatch(r"[\w.-]+==[\w.]+", line) for line in lines), "exact versions only"
    build = tomllib.loads((ROOT / "pyproject.toml").read_text())["build-system"]["requires"]
    asked = [
        *PROJECT["dependencies"],
        *PROJECT["optional-dependencies"]["dev"],
        *EXTRA,
        *CLUSTER,
        *RERUN,
        *build,
    ]
    declared = names(asked)
    assert declared <= names(lines)
    assert len(names(lines)) == len(lines), "a package is pinned twice"


def test_bundles_tasks_and_commands_need_no_torch() -> None:
    code = (
        "import sys\n"
        "extra = 'torch', 'rsl_rl', 'tensordict', 'onnx', 'onnxruntime', 'warp', 'mujoco_warp'\n"
        "class Missing:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name in extra:\n"
        "            raise ImportError(name)\n"
        "sys.meta_path.insert(0, Missing())\n"
        "import workbench.bundle, workbench.training.evaluate, workbench.training.record\n"
        "import workbench.cli.train, workbench.cli.evaluate\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_what_is_slow_to_load_waits_until_it_is_used() -> None:
    code = (
        "import sys\n"
        "import workbench.comparison, workbench.recordings, workbench.report, workbench.verification\n"
        "slow = 'asammdf', 'matplotlib', 'pandas', 'pint', 'plotly', 'scipy.signal', 'scipy.stats', 'torch'\n"
        "print(*(name for name in slow if name in sys.modules))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.split() == []


def test_commands_simulate_without_a_window_library(tmp_path: Path) -> None:
    code = (
        "import sys\n"
        "from workbench.cli import main\n"
        "sys.argv = ['workbench', 'normalize', 'leg', '-o', 'tree.xml', '--quiet']\n"
        "try:\n"
        "    main()\n"
        "finally:\n"
        "    print(*(name for name in ('glfw', 'mujoco') if name in sys.modules))\n"
    )
    free = {k: v for k, v in os.environ.items() if k != "MUJOCO_GL"}
    done = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True, cwd=tmp_path, env=free
    )
    assert done.stdout.split() == ["mujoco"]


def test_the_citation_names_the_version() -> None:
    text = (ROOT / "CITATION.cff").read_text()
    [version] = re.findall(r"^version: (.+)$", text, re.M)
    [changelog] = re.findall(r"^## ([\d.]+)$", (ROOT / "CHANGELOG.md").read_text(), re.M)[:1]
    assert version == VERSION == changelog


def test_a_wheel_built_from_the_sdist_runs_outside_of_a_clone(tmp_path: Path) -> None:
    build = "import hatchling.build as build; print(build.build_{}({!r}))"

    def built(what: str, folder: Path) -> Path:
        code = build.format(what, str(tmp_path))
        done = subprocess.run(
            [sys.executable, "-c", code], cwd=folder, check=True, capture_output=True, text=True
        )
        return tmp_path / done.stdout.split()[-1]

    with tarfile.open(built("sdist", ROOT)) as sdist:
        sdist.extractall(tmp_path, filter="data")
    [source] = (entry for entry in tmp_path.iterdir() if entry.is_dir())
    with zipfile.ZipFile(built("wheel", source)) as wheel:
        wheel.extractall(tmp_path / "site")
    for inside, folder in (("workbench", "workbench"), ("workbench/_models", "models")):
        files = {file.relative_to(ROOT / folder) for file in (ROOT / folder).rglob("*") if file.is_file()}
        files = {file for file in files if "__pycache__" not in file.parts}
        assert len(files) > 10 and all((tmp_path / "site" / inside / file).is_file() for file in files)
    metadata = (tmp_path / "site" / f"robot_workbench-{VERSION}.dist-info" / "METADATA").read_text()
    assert "Description-Content-Type: text/markdown" in metadata and "License-Expression: MIT" in metadata
    classifiers = set(re.findall("^Classifier: (.*)$", metadata, re.M))
    assert {"Development Status :: 5 - Production/Stable", "Typing :: Typed"} <= classifiers
    page = metadata.partition("\n\n")[2]
    assert "pip install robot-workbench" in page and "## Results" in page
    assert not re.search(r"\]\((?!https?://)|<img|\bmake (demo|test)\b", page), "leads nowhere on an index"
    code = (
        "import workbench; from workbench.cli import main; print(workbench.load_model('leg').source); main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, "--version"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path / "site")},
        check=True,
        capture_output=True,
        text=True,
    )
    model, said = done.stdout.splitlines()
    assert Path(model) == tmp_path / "site" / "workbench" / "_models" / "leg.toml"
    assert said == f"workbench {VERSION}"
