"""The same inputs and seed give the same bytes, whatever the hash seed, the folder and the threads."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from hashlib import sha256
from pathlib import Path

import numpy
import pytest

from workbench.core import InputError
from workbench.core.paths import models_folder
from workbench.core.provenance import provenance
from workbench.recordings import save_recording
from workbench.rigs import HiddenEffect, VirtualLeg, chirp, validation

#: Commands one after another in one process: most of the time of each is its imports.
_SCRIPT = """
import sys
from workbench.cli import main
for words in sys.argv[1:]:
    sys.argv = ["workbench", *words.split(), "--quiet"]
    try:
        main()
    except SystemExit as done:
        assert not done.code, (words, done.code)
"""


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, bytes]]:
    """What two processes answered to the same questions, each in a folder of its own, by file."""
    leg = VirtualLeg([HiddenEffect("torque_bias", "knee", parameters={"torque": 0.5})], seed=4)
    recordings = leg.run([chirp("knee", duration=1.5), validation(2, duration=1.0)])
    both = []
    for k in (1, 2):
        folder = tmp_path_factory.mktemp(f"run{k}")
        for recording in recordings:
            save_recording(recording, folder / f"{recording.name}.toml")
        commands = (
            "excite actuator -o bench.toml --amplitude 3 --f-max 100 --periods 3 --json excite.json",
            "record actuator bench.toml -o data",
            "compare leg chirp_knee.toml --json compare.json",
            "diagnose leg chirp_knee.toml --holdout validation.toml --json diagnose.json",
            "check leg --samples 3 --json check.json",
            "identify actuator data/bench.toml --json identify.json",
            "frf actuator data/bench.toml --json frf.json",
        )
        threads = {"OPENBLAS_NUM_THREADS": str(k), "OMP_NUM_THREADS": str(k), "PYTHONHASHSEED": str(k)}
        done = subprocess.run(
            [sys.executable, "-c", _SCRIPT, *commands],
            cwd=folder, env={**os.environ, **threads}, capture_output=True, text=True,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        both.append({f.name: f.read_bytes() for f in folder.glob("*.json")})
    return both


def test_the_same_inputs_give_the_same_bytes(told: list[dict[str, bytes]]) -> None:
    first, second = told
    assert len(first) == 6
    assert first == second


def test_results_say_what_they_were_made_of(told: list[dict[str, bytes]]) -> None:
    for name, text in told[0].items():
        made = json.loads(text)["provenance"]
        assert made["versions"]["numpy"] == numpy.__version__ and made["versions"]["workbench"], name
        assert made["inputs"], name
    made = json.loads(told[0]["diagnose.json"])["provenance"]
    assert made["seeds"] == {"noise": 0}
    hashes = {each["file"]: each["sha256"] for each in made["inputs"]}
    assert list(hashes) == [
        *("leg.toml", "leg.xml", "leg.sdf"),
        *("chirp_knee.toml", "chirp_knee.csv.gz", "validation.toml", "validation.csv.gz"),
    ]
    assert hashes["leg.toml"] == sha256((models_folder() / "leg.toml").read_bytes()).hexdigest()


def test_a_file_counts_once_and_must_be_there(tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_text("format = 1")
    assert provenance([file, file])["inputs"] == [
        {"file": "a.toml", "sha256": sha256(b"format = 1").hexdigest()}
    ]
    with pytest.raises(InputError, match="cannot read"):
        provenance([tmp_path / "gone.toml"])
