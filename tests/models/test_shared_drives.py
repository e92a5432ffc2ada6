"""An actuator that moves two joints is no drive of each: its tendon is a row of the transmission."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.cli.here import run
from workbench.effects import load_model
from workbench.models import write_model

ARM = """<mujoco><worldbody><body><joint name="a" axis="0 1 0"/><geom size="0.1"/><site name="s"/>
<body pos="0 0 -0.3"><joint name="b" axis="0 1 0"/><geom size="0.1"/><site name="t"/></body></body>
</worldbody>
<tendon>{tendon}</tendon><actuator><motor name="m1" joint="a"/><motor name="m2" tendon="belt"/></actuator>
</mujoco>"""
BELT = '<fixed name="belt"><joint joint="a" coef="0.5"/><joint joint="b" coef="1"/></fixed>'
CABLE = '<spatial name="belt"><site site="s"/><site site="t"/></spatial>'
ALONE = '<fixed name="belt"><joint joint="b" coef="2"/></fixed>'


def written(folder: Path, tendon: str) -> Path:
    (folder / "arm.xml").write_text(ARM.format(tendon=tendon))
    return folder / "arm.xml"


def test_what_moves_two_joints_is_a_row_of_the_transmission(tmp_path: Path) -> None:
    model = load_model(written(tmp_path, BELT))
    assert model.axes == ("m1", "m2") and model.joints == ("a", "b")
    np.testing.assert_array_equal(model.transmission, [[1.0, 0.0], [0.5, 1.0]])
    write_model(model, tmp_path / "arm.toml")
    np.testing.assert_array_equal(load_model(tmp_path / "arm.toml").transmission, model.transmission)
    assert load_model(written(tmp_path, ALONE)).axes == ("a", "b")


def test_what_no_matrix_says_is_refused_until_one_is_stated(tmp_path: Path) -> None:
    """A cable along sites, and one motor for two joints."""
    one = ARM.replace('<motor name="m1" joint="a"/>', "").format(tendon=BELT)
    for text, said in (
        (ARM.format(tendon=CABLE), "what its tendon passes"),
        (one, "joints a and b together"),
    ):
        (tmp_path / "arm.xml").write_text(text)
        done = run("check", tmp_path / "arm.xml")
        assert done.returncode == 2 and len(done.stderr.strip().splitlines()) == 1
        assert f"'m2' moves {said}" in done.stderr and "state [transmission]" in done.stderr
    (tmp_path / "arm.toml").write_text(
        'format = 1\nname = "arm"\nserial = "arm.xml"\n[transmission]\njoints = ["a", "b"]\n'
        "matrix = [[1, 0], [0.5, 1]]\n"
    )
    np.testing.assert_array_equal(load_model(tmp_path / "arm.toml").transmission, [[1.0, 0.0], [0.5, 1.0]])
