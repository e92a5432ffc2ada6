"""What a shell offers when a word is completed, as bash asks for it; and that it does not take long."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from workbench.cli import complete
from workbench.effects import EFFECTS
from workbench.models import VARIANTS
from workbench.rigs import demo_experiments, plate_experiments, revealing_experiments
from workbench.training import LEG_RANDOMISATION, TASKS
from workbench.training.loggers import LOGGERS

_SLOW = ("mujoco", "pydrake", "pinocchio", "scipy", "matplotlib", "torch", "numba")
_PROGRAM = f"""
import sys
sys.argv = ["workbench", *sys.argv[1:]]
from workbench.cli import main
try:
    main()
finally:
    print("slow:", *[name for name in {_SLOW} if name in sys.modules], file=sys.stderr)
"""


def asked(line: str, cwd: Path) -> list[str]:
    """What bash would show for this line, the cursor at its end."""
    words = line.split(" ")
    done = subprocess.run(
        [sys.executable, "-c", _PROGRAM],
        env={
            **os.environ, "_WORKBENCH_COMPLETE": "complete_bash",
            "COMP_WORDS": "\n".join(words), "COMP_CWORD": str(len(words) - 1),
        },
        capture_output=True, text=True, cwd=cwd,
    )  # fmt: skip
    assert done.stderr == "slow:\n", "something slow was imported"
    return done.stdout.split()


def test_names_that_are_offered_are_those_that_there_are() -> None:
    assert tuple(TASKS) == complete.TASKS and tuple(VARIANTS) == complete.VARIANTS
    assert tuple(LEG_RANDOMISATION) == complete.LEGS
    assert LOGGERS == complete.LOGGERS
    leg = [e.name for e in (*demo_experiments(), *revealing_experiments())]
    assert {
        "leg": tuple(leg),
        "leg_on_plate": tuple(e.name for e in plate_experiments()),
    } == complete.EXPERIMENTS
    assert complete.effect_names() == {e.name: not e.locations for e in EFFECTS}
    for effect in EFFECTS:
        assert complete.parameter_names(effect.name) == tuple(p.name for p in effect.parameters)
    assert complete.parameter_names("../core/units") == ()


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("workbench add leg coul", ["coulomb_friction@hip", "coulomb_friction@knee"]),
        ("workbench add leg coulomb_friction @", ["hip", "knee"]),  # as bash parts effect@axis
        ("workbench add leg backlash@knee gap=0.01 ", ["stiffness="]),
        ("workbench train reach --variant s3", ["s3n_act", "s3n_full"]),
        ("workbench compare l", ["leg", "leg_kin_only", "leg_on_plate", "leg_s3n_act", "leg_s3n_full"]),
    ],
)
def test_bash_is_offered(line: str, offered: list[str], tmp_path: Path) -> None:
    assert asked(line, tmp_path) == offered


def test_models_of_ones_own_are_offered_and_their_axes_known(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("my_arm.xml").write_text('<mujoco><body><joint name="pan"/><joint type="free"/></body></mujoco>')
    Path("mine.toml").write_text('format = 1\nname = "mine"\nserial = "my_arm.xml"\naxes = ["tilt"]\n')
    Path("my_recording.toml").write_text('format = 1\nname = "r"\n')
    assert complete.models("m") == ["mine.toml", "my_arm.xml"]
    assert "mine.toml" in complete.models("") and "leg" in complete.models("")
    assert complete.models("elsewhere/m") == [], "the shell completes files"
    for model, axes in (("mine.toml", ("tilt",)), ("my_arm.xml", ("pan",)), ("gone.toml", ()), ("", ())):
        assert complete._axes(model) == axes
    Path("bad.toml").write_text("axes = [")
    assert complete._axes("bad.toml") == () and "coulomb_friction" in complete._places(())


def test_what_is_installed_for_bash_completes(tmp_path: Path) -> None:
    """The file that --install-completion writes, asked as bash asks it."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = {**os.environ, "HOME": str(tmp_path), "PATH": path}
    install = ["workbench", "--install-completion", "bash"]
    told = {**environment, "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    subprocess.run(install, env=told, check=True, capture_output=True)
    script = """
        . ~/.bashrc
        COMP_WORDS=(workbench train p) COMP_CWORD=2
        $(complete -p workbench | sed -E 's/.*-F ([^ ]+) .*/\\1/') workbench
        echo "${COMPREPLY[@]}"
    """
    done = subprocess.run(["bash", "-c", script], env=environment, capture_output=True, text=True)
    assert done.stdout.split() == ["pitch-in-place"], done.stderr
