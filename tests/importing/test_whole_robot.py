"""One limb of a whole robot: what else could move is held, and each leg's loops close by themselves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.biped import BASES, biped
from tests.cli.here import run
from workbench.core import Coupling, Mechanism
from workbench.importing import contents_of
from workbench.mechanism import ClosedChain, held_rest
from workbench.mechanism.tree import Tree
from workbench.models import read_model
from workbench.s3n import PostureChain, PostureDependent
from workbench.s3n.posture_chain import PostureDynamics
from workbench.verification import verify


@pytest.mark.parametrize("base", BASES.values(), ids=BASES)
def test_an_ankle_of_a_wholebiped(tmp_path: Path, base: str) -> None:
    file = biped(tmp_path, base)
    told = contents_of(file)
    assert told.motors == ("left_hip", "left_ankle", "right_hip", "right_ankle") and told.loops == 2
    assert told.springs == ("left_leaf", "right_leaf")
    words = [
        "--drive",
        "left_ankle",
        "--joint",
        "left_ankle",
        "--start",
        "left_ankle=0.4",
        "-o",
        tmp_path / "own.toml",
    ]
    bare = run("import", file, *words)
    assert bare.returncode == 2 and "still move" in bare.stderr
    done = run("import", file, *words, "--hold-rest")
    assert done.returncode == 0, done.stderr
    said = " ".join(done.stdout.split())
    assert (
        "Held joints: left_hip" in said and "right_leaf" in said and "left_crank" not in said.split("Held")[1]
    )
    model = read_model(tmp_path / "own.toml")
    # the crank and its rod turn with the foot: the drive is the joint, and still the tree is not all
    assert model.posture_dependent and model.transmission.tolist() == [[1.0]]
    assert verify(model, samples=4).passed


def test_a_joint_that_loops_move_on_the_way_is_refused(tmp_path: Path) -> None:
    file = biped(tmp_path)
    follows = '<joint joint1="left_leaf" joint2="left_hip" polycoef="0 0.5 0 0 0"/></equality>'
    file.write_text(file.read_text().replace("</equality>", follows))
    words = [w for n in ("left_hip", "left_ankle") for w in ("--drive", n, "--joint", n)]
    done = run(
        "import", file, *words, "--start", "left_ankle=0.4", "--hold-rest", "-o", tmp_path / "own.toml"
    )
    assert done.returncode == 2
    assert "one joint per drive" in done.stderr and "leave out left_ankle and its drive" in done.stderr


def test_a_keyframe_is_where_assembly_begins(tmp_path: Path) -> None:
    file = biped(tmp_path)
    qpos = "0 0 0.7 1 0 0 0 0.1 0 0.4 -0.3 0.5 -0.1 0 0.3 -0.2 0.6"
    file.write_text(
        file.read_text().replace("</mujoco>", f'<keyframe><key qpos="{qpos}"/></keyframe></mujoco>')
    )
    words = ["--drive", "left_ankle", "--joint", "left_ankle", "--hold-rest", "-o", tmp_path / "own.toml"]
    assert run("import", file, *words).returncode == 0
    model = read_model(tmp_path / "own.toml")
    assert model.closed_chain is not None
    held = {c.joint: c.polynomial[0] for c in model.closed_chain.couplings if c.follows is None}
    assert held["left_hip"] == pytest.approx(0.1) and held["right_hip"] == pytest.approx(-0.1)
    assert dict(model.closed_chain.start)["left_hip"] == pytest.approx(0.1)


def test_what_is_held_leaves_as_many_freedoms_as_drives(tmp_path: Path) -> None:
    sdf = Path(__file__).parents[2] / "models" / "closed_chain" / "leg.sdf"
    mechanism = Mechanism(sdf, ("crank_pin",), ("knee",))
    held = held_rest(mechanism, ["hip"])
    assert [c.joint for c in held] == ["hip"] and held[0].follows is None
    own = Mechanism(sdf, ("crank_pin",), ("knee",), couplings=(Coupling("hip", None, (0.3,)),))
    chain = ClosedChain(own)
    assert np.isfinite(chain.serial_dynamics(np.array([1.0]), np.zeros(1)).mass).all()


def test_loops_of_the_other_leg_are_left_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = biped(tmp_path)
    words = ["--drive", "left_ankle", "--joint", "left_ankle", "--start", "left_ankle=0.4", "--hold-rest"]
    assert run("import", file, *words, "-o", tmp_path / "own.toml").returncode == 0
    model = read_model(tmp_path / "own.toml")
    assert model.closed_chain is not None
    chain, asked, jacobian = ClosedChain(model.closed_chain), list[Sequence[int] | None](), Tree.gap_jacobian

    def told(tree: Tree, rows: Sequence[int] | None = None) -> np.ndarray:
        asked.append(rows)
        return jacobian(tree, rows)

    monkeypatch.setattr(Tree, "gap_jacobian", told)
    before = chain.tree_position(chain.drive_position(np.array([0.3])))
    after = chain.tree_position(chain.drive_position(np.array([0.8])))
    moved = {n for n, change in zip(chain.coordinates, np.abs(after - before), strict=True) if change > 0.0}
    assert moved == {"left_ankle", "left_crank", "left_rod"}
    # of two loops and the joints that are held, those of one loop
    assert asked and all(rows is not None and len(rows) <= 3 for rows in asked)


def test_the_limb_alone_moves_as_in_the_whole_robot(tmp_path: Path) -> None:
    file = biped(tmp_path)
    words = ["--drive", "left_ankle", "--joint", "left_ankle", "--start", "left_ankle=0.4", "--hold-rest"]
    assert run("import", file, *words, "-o", tmp_path / "own.toml").returncode == 0
    mechanism = read_model(tmp_path / "own.toml").closed_chain
    assert mechanism is not None
    chain, whole = ClosedChain(mechanism), Tree(mechanism)
    q, v = chain.drive_position(np.array([0.6])), np.array([3.0])
    # by the whole tree: its speeds are a difference of postures, and what its weight does is one of energies
    h = 1e-5
    theta, ahead, behind = (chain.tree_position(q + d) for d in (0.0, h, -h))
    whole.move(theta)
    slope = (ahead - behind) / (2 * h)
    assert chain.projection(q)[:, 0] == pytest.approx(slope, abs=1e-8)
    mass = whole.mass()
    assert np.abs(whole.gap()).max() < 1e-9
    reduced = chain.reduced_dynamics(q, v)
    assert reduced.mass[0, 0] == pytest.approx(slope @ mass @ slope, rel=1e-7)
    assert reduced.gravity[0] == pytest.approx(slope @ whole.gravity(), rel=1e-7)
    assert len(chain.coordinates) == len(theta)


def test_links_of_a_mechanism_are_solved_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = biped(tmp_path)
    words = ["--drive", "left_ankle", "--joint", "left_ankle", "--start", "left_ankle=0.4", "--hold-rest"]
    assert run("import", file, *words, "-o", tmp_path / "own.toml").returncode == 0
    model, count = read_model(tmp_path / "own.toml"), []
    asked = PostureChain.dynamics

    def counted(chain: PostureChain, q: np.ndarray, v: np.ndarray | None = None) -> PostureDynamics:
        count.append(len(q))
        return asked(chain, q, v)

    monkeypatch.setattr(PostureChain, "dynamics", counted)
    first = PostureDependent(model).mass(np.array([[0.5]]))
    once = len(count)
    heavier = replace(model, actuators=replace(model.actuators, inertia=(0.5,)))
    second = PostureDependent(heavier).mass(np.array([[0.5]]))
    assert once > 0 and len(count) == once
    assert (second - first)[0, 0, 0] == pytest.approx(0.5 - model.actuators.inertia[0])
