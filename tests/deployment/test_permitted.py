"""What is asked before the first torque: is the policy approved, may the robot what the policy counts on."""

from __future__ import annotations

from dataclasses import replace
from datetime import date, timedelta
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from typer.testing import CliRunner

from tests.can.make import motor, table, written
from tests.deployment.robot import LIMITS, RANGES
from tests.deployment.test_deploy import bundle, leg
from workbench.bundle import PolicyBundle, objections, read_bundle
from workbench.can import load_config
from workbench.cli.app import app
from workbench.core import InputError
from workbench.deployment import joints_of
from workbench.deployment.command import RATE, Command
from workbench.deployment.deploy import deploy
from workbench.deployment.limits import limits_of
from workbench.deployment.permitted import permitted, refuse_untested
from workbench.deployment.policies import check_bundle
from workbench.deployment.simulated import SimulatedNetwork
from workbench.deployment.trained import TILT, trained_of

RECORD = {
    "files": {"leg.toml": "1"}, "variant": "exact", "passed": True, "recordings": [{"name": "a"}],
    "consistent": True,
}  # fmt: skip


def approved(folder: Path, **record: object) -> PolicyBundle:
    loaded = read_bundle(bundle(folder))
    own = {**loaded.manifest, "record": {**RECORD, **record}, "model": {"files": {"leg.toml": "1"}}}
    return replace(loaded, manifest=own)


def with_limits(folder: Path, **limits: object) -> Path:
    path = leg(folder)
    motors = [
        motor(axis, k + 1, limits={**LIMITS, **limits}, ranges=RANGES)
        for k, axis in enumerate(("hip", "knee"))
    ]
    content = {**load_config(path).model_dump(mode="json", exclude_none=True, exclude={"source"})}
    path.write_text(tomli_w.dumps({**content, "motor": motors}))
    return path


@pytest.mark.parametrize(
    ("record", "said"),
    [
        ({}, None),
        ({"files": {"leg.toml": "2"}}, "other model files"),
        ({"variant": "kin_only"}, "for variant kin_only, not exact"),
        ({"passed": False}, "a check of its model"),
        ({"recordings": []}, "compared with no recording"),
        ({"consistent": False}, "above the noise"),
        ({"consistent": "yes"}, "above the noise"),
    ],
)
def test_an_approval_is_what_approve_wrote_of_this_very_model(tmp_path: Path, record, said) -> None:
    against = objections(approved(tmp_path, **record))
    assert not against if said is None else len(against) == 1 and said in against[0]


def test_a_policy_that_is_not_approved_is_for_dry_runs(tmp_path: Path) -> None:
    config, loaded = load_config(leg(tmp_path)), read_bundle(bundle(tmp_path))
    with pytest.raises(InputError, match=r"not approved: its model had no verification .*--unapproved"):
        permitted(config, loaded, dry=False, unapproved=False, tested=False)
    for dry, told in ((True, "hardware needs --unapproved"), (False, "it runs at your own risk")):
        [line] = permitted(config, loaded, dry=dry, unapproved=not dry, tested=False)[1]
        assert line == f"not approved, {told}: its model had no verification record"
    assert not permitted(config, approved(tmp_path), dry=False, unapproved=False, tested=False)[1]


def test_the_command_refuses_it_before_a_bus_is_opened(tmp_path: Path) -> None:
    words = [str(bundle(tmp_path)), str(leg(tmp_path)), "--yes"]
    done = CliRunner().invoke(app, ["deploy", *words])
    assert isinstance(done.exception, InputError) and "not approved" in str(done.exception)
    done = CliRunner().invoke(app, ["deploy", *words, "--unapproved"])
    assert "cannot be opened" in str(done.exception)
    done = CliRunner().invoke(app, ["deploy", *words, "--dry-run", "--seconds", "1"])
    assert done.exit_code == 0 and "not approved" in done.stderr


def test_what_needs_no_bus_is_checked_before_anything_moves(
    tmp_path: Path,
) -> None:
    made = list[str]()

    def network() -> SimulatedNetwork:
        made.append("motors")
        return SimulatedNetwork(load_config(leg(tmp_path)))

    weak, loaded = load_config(with_limits(tmp_path, torque=3.0)), read_bundle(bundle(tmp_path))
    with pytest.raises(InputError, match="'hip' may have 3 N m"):
        deploy(weak, loaded, 1.0, network=network, confirm=lambda: made.append("asked"))
    assert not made
    done = deploy(
        load_config(leg(tmp_path)), loaded, 0.1, network=network, confirm=lambda: made.append("asked")
    )
    assert done["fault"] is None and made == ["asked", "motors"]


@pytest.mark.parametrize(
    ("control", "limits", "said"),
    [
        ({}, {"torque": 3.0}, "trained with a torque limit of 24 N m, 'hip' may have 3 N m"),
        ({"velocity_limit": 60.0}, {}, "trained with a velocity limit of 60 rad/s, 'hip' may have 40"),
        ({}, {"position": [-0.5, 4.0]}, "the policy's posture has 'hip' at -0.55 rad, outside -0.5 to 4"),
        ({"joints": ["knee", "hip"]}, {}, "the policy's joints are knee, hip, in this order"),
    ],
)
def test_a_robot_that_may_do_less_is_refused_by_name(tmp_path: Path, control, limits, said) -> None:
    config = load_config(with_limits(tmp_path, **limits))
    with pytest.raises(InputError) as caught:
        check_bundle(read_bundle(bundle(tmp_path, **control)), config, joints_of(config))
    assert said in str(caught.value)


def test_a_robot_that_may_do_more_is_held_to_what_was_trained(tmp_path: Path) -> None:
    config = load_config(leg(tmp_path))
    loaded = read_bundle(bundle(tmp_path, torque_limit=[10.0, 24.0], velocity_limit=20.0))
    check_bundle(loaded, config, joints_of(config))
    limits, lines = permitted(config, loaded, dry=True, unapproved=False, tested=False)
    assert limits.torque.tolist() == [10.0, 24.0] and limits.velocity.tolist() == [20.0, 20.0]
    assert lines[0].endswith("(10 N m or more): hip")


def mit(folder: Path, protocol: str = "mit", **more: object):
    told = {"watchdog_source": "the vendor's tool", **more}
    motors = [motor("hip", 1, protocol=protocol, limits=LIMITS, ranges=RANGES, **told),
              motor("knee", 2, limits=LIMITS, ranges=RANGES)]  # fmt: skip
    return load_config(written(folder, table(motors)))


def test_an_odrive_tells_its_watchdog_where_endpoints_are_known(tmp_path: Path) -> None:
    ends = {"watchdog_timeout": 481, "enable_watchdog": 482}
    known = mit(tmp_path, "odrive", endpoints=ends)
    assert not permitted(known, None, dry=False, unapproved=False, tested=False)[1]
    refuse_untested(known)


@pytest.mark.parametrize("protocol", ["mit", "odrive"])
def test_a_watchdog_that_nobody_reads_leaves_a_tenth_of_torque(tmp_path: Path, protocol: str) -> None:
    config = mit(tmp_path, protocol)
    limits, [line] = permitted(config, None, dry=False, unapproved=False, tested=False)
    assert limits.torque == pytest.approx([2.4, 24.0]) and "for hip: no watchdog can be read" in line
    assert limits_of(config).torque.tolist() == [24.0, 24.0]
    with pytest.raises(InputError, match="watchdog_tested"):
        refuse_untested(config)
    assert not permitted(config, None, dry=False, unapproved=False, tested=True)[1]
    seen = mit(tmp_path, protocol, watchdog_tested=date(2026, 5, 1))
    assert not permitted(seen, None, dry=False, unapproved=False, tested=False)[1]
    refuse_untested(seen)
    with pytest.raises(InputError, match="is in the future"):
        mit(tmp_path, watchdog_tested=date.today() + timedelta(days=2))


def test_a_command_beyond_what_was_trained_is_clipped_and_said(tmp_path: Path) -> None:
    walks = replace(trained_of(read_bundle(bundle(tmp_path))), looks=True)
    asked = np.array([2.0, 0.0, -1.0])
    known = replace(walks, commands=np.array([(-0.6, 1.2), (-0.3, 0.3), (-1.0, 1.0)]))
    within, line = known.clipped(asked)
    assert within.tolist() == [1.2, 0.0, -1.0] and line.startswith(
        "the command 2 0 -1 is clipped to 1.2 0 -1"
    )
    assert known.clipped(within)[1] == ""
    assert "does not say" in walks.clipped(asked)[1]
    within, line = replace(walks, looks=False).clipped(asked)
    assert not within.any() and "left out" in line


def test_a_command_is_never_there_at_once() -> None:
    command = Command(np.array([0.8, 0.0, -0.8]))
    steps = np.array([command.advance(0.018).copy() for _ in range(100)])
    assert (np.abs(np.diff(steps, axis=0)) <= np.array(RATE) * 0.018 + 1e-12).all()
    assert steps[0, 0] < 0.02 and steps[-1].tolist() == [0.8, 0.0, -0.8]
    command.stand()
    assert not command.value.any()


def test_only_a_policy_that_feels_its_base_can_fall(tmp_path: Path) -> None:
    trained = trained_of(read_bundle(bundle(tmp_path)))
    assert np.isinf(trained.tilt) and 53.0 < np.degrees(TILT) < 53.2
