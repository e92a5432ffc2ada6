"""An actuator that moves two joints is no drive of each: the transmission has to be stated."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.cli.here import run
from workbench.core import InputError
from workbench.effects import load_model

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


def test_what_moves_two_joints_is_refused_with_the_matrix_to_state(tmp_path: Path) -> None:
    file = written(tmp_path, BELT)
    with pytest.raises(InputError, match=r"'m2' moves joints a and b together.*\[\[1, 0\], \[0.5, 1\]\]"):
        load_model(file)
    (tmp_path / "arm.toml").write_text(
        'format = 1\nname = "arm"\nserial = "arm.xml"\n[transmission]\njoints = ["a", "b"]\n'
        "matrix = [[1, 0], [0.5, 1]]\n"
    )
    np.testing.assert_array_equal(load_model(tmp_path / "arm.toml").transmission, [[1.0, 0.0], [0.5, 1.0]])


@pytest.mark.parametrize("command", [("check",), ("normalize", "-o", "x.xml"), ("excite", "-o", "x.toml")])
def test_every_command_says_so_in_one_line(tmp_path: Path, command: tuple[str, ...]) -> None:
    done = run(command[0], written(tmp_path, BELT), *command[1:], cwd=tmp_path)
    assert done.returncode == 2 and len(done.stderr.strip().splitlines()) == 1
    assert "moves joints a and b together" in done.stderr


def test_a_cable_along_sites_is_refused_and_a_tendon_of_one_joint_is_none(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="'m2' moves what its tendon passes"):
        load_model(written(tmp_path, CABLE))
    assert load_model(written(tmp_path, ALONE)).driven == ("a", "b")
