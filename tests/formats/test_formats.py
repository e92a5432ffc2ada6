"""Files of version 1 load for ever; files of a newer version say that workbench has to be updated.

What stands in `v1` was written as version 1 and is never written again: a change that cannot read it needs a
new number and a way from the old one.
"""

from __future__ import annotations

import json
import re
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from workbench.bundle import read_bundle
from workbench.can import load_config
from workbench.cli.add import read_findings
from workbench.core import EffectKey, InputError
from workbench.frf import load_design
from workbench.models import read_model
from workbench.recordings import load_recording
from workbench.training.record import read_record

V1 = Path(__file__).parent / "v1"


def test_a_recording() -> None:
    recording = load_recording(V1 / "recording.toml")
    assert recording.axes == ("hip", "knee") and len(recording) == 60
    assert recording.signals["position"][0] == pytest.approx([0.0, 0.3])
    assert recording.controller.kind == "pd" and recording.controller.kp == (50.0, 50.0)
    assert not recording.timing.initial_at_rest


def test_a_model() -> None:
    model = read_model(V1 / "model.toml")
    assert model.variant == "exact" and model.axes == ("hip", "crank")
    assert np.array_equal(model.transmission, [[1.0, 0.0], [1.0, 1.0]])
    assert model.actuators.damping == (0.1, 0.1) and model.actuators.delay_s == 0.003
    assert model.linkage is not None and model.linkage.M22 == 0.002 and model.linkage.identified
    added = model.effects[-1]
    assert added.key == EffectKey("coulomb_friction", "crank") and added.parameters["torque"].value == 0.25
    assert model.sliding_speed == 0.001 and model.payload_site == "foot"


def test_a_can_configuration() -> None:
    config = load_config(V1 / "can.toml")
    assert config.axes == ("hip", "crank") and config.loop.period_s == 0.004
    assert [m.protocol for m in config.motor] == ["damiao", "mit"]
    assert config.mechanism[0].model == "leg"


def test_a_design() -> None:
    design = load_design(V1 / "design.toml")
    assert design.axes == ("motor",) and design.experiments.shape == (1, 201, 1)
    spectrum = np.abs(np.fft.rfft(design.experiments[0, :, 0]))
    assert set(np.flatnonzero(spectrum > 1e-3 * spectrum.max())) == set(design.lines)


def test_a_verification_record() -> None:
    record = read_record(V1 / "model.record.json")
    assert record is not None and record["passed"] and record["variant"] == "exact"


def test_a_diagnosis() -> None:
    [found] = read_findings(str(V1 / "diagnosis.json"))
    assert found.key == EffectKey("coulomb_friction", "knee") and found.parameters["torque"].std == 0.003


def test_a_bundle() -> None:
    bundle = read_bundle(V1 / "bundle.zip")
    assert bundle.task == "reach" and bundle.variant == "s3n_full"
    assert bundle.policy == b"not run by this test" and bundle.control.transmission.shape == (2, 2)
    assert bundle.observations[0].start == 0


@pytest.mark.parametrize(
    ("name", "read"),
    [
        ("recording.toml", load_recording),
        ("model.toml", read_model),
        ("can.toml", load_config),
        ("design.toml", load_design),
        ("model.record.json", read_record),
        ("diagnosis.json", read_findings),
        ("bundle.zip", read_bundle),
    ],
)
def test_a_file_of_a_newer_version_says_so(name: str, read: Callable[[Any], Any], tmp_path: Path) -> None:
    shutil.copytree(V1, tmp_path, dirs_exist_ok=True)
    file = tmp_path / name
    if name.endswith(".zip"):
        with zipfile.ZipFile(V1 / name) as old, zipfile.ZipFile(file, "w") as new:
            for part in old.namelist():
                data = old.read(part)
                new.writestr(part, _newer(data.decode()) if part == "bundle.json" else data)
    else:
        file.write_text(_newer(file.read_text()))
    with pytest.raises(InputError, match=r"newer workbench.*update workbench") as caught:
        read(file)
    assert str(file) in str(caught.value)


def _newer(text: str) -> str:
    """The next format, with a key that this version cannot know."""
    if text.startswith("{"):
        return json.dumps({**json.loads(text), "format": 2, "novelty": 1})
    return re.sub(r"^format = 1$", "format = 2\nnovelty = 1", text, flags=re.M)
