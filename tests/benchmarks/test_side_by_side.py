"""What must not become slow, as ratios of CPU times of work that takes turns: the machine cancels out.

Limits are generous: they catch what is done twice, or once per row instead of once per recording.
"""

from __future__ import annotations

import gzip
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import mujoco
import pyarrow.csv as pacsv
import pytest
from side_by_side import spread, times_as_long

from workbench.comparison import Replay, compare, replay_of
from workbench.core import Recording
from workbench.diagnosis.data import gather
from workbench.diagnosis.problem import starting_fit
from workbench.diagnosis.screening.screen import screen
from workbench.diagnosis.screening.sensitivity import Linearisation
from workbench.effects import load_model
from workbench.models import Model
from workbench.recordings import load_recording, save_recording
from workbench.rigs import VirtualLeg, chirp
from workbench.s3n import normalise


@pytest.fixture(scope="module")
def recording() -> Recording:
    return VirtualLeg(seed=1).run([chirp("knee", duration=2.0)])[0]


def runs(replay: Replay, model: Model, count: int) -> Callable[[], object]:
    """So many plain simulations of the recordings."""
    return lambda: replay.run([model] * count)


def test_a_ratio_is_that_of_the_work() -> None:
    once, thrice = (lambda n=n: sum(range(100_000 * n)) for n in (1, 3))
    assert times_as_long(thrice, once).median == pytest.approx(3.0, rel=0.3)
    found = spread([3.0, 1.0, 2.0])
    assert (found.median, found.least, found.most, found.repeats) == (2.0, 1.0, 3.0, 3)


def test_the_catalogue_is_screened_in_some_simulations_time(recording: Recording) -> None:
    model = load_model("leg")
    data, simulated = gather(model, [recording], (), 0)
    start = starting_fit(model, data, simulated.clean)

    def screened() -> int:
        linearisation = Linearisation.of(model, data, start.simulated, 1)
        return len(screen(linearisation, data))

    places = screened()
    few = runs(replay_of(model, [recording]), model, 10)
    assert places > 50
    # about 0.25; by differences more than 1
    assert 10 * times_as_long(screened, few, 3).median < 0.7 * places


def test_a_comparison_takes_hardly_longer_than_its_simulations(recording: Recording) -> None:
    model, draws = load_model("leg"), 8
    needed = lambda: replay_of(model, [recording]).with_noise(model, 0, draws)  # noqa: E731
    assert times_as_long(lambda: compare(model, [recording], draws=draws), needed, 3).median < 1.5  # 1.1
    plain = runs(replay_of(model, [recording]), model, 1 + draws)
    assert times_as_long(needed, plain, 3).median < 2.0  # 1.1


@pytest.mark.parametrize("variant", ["s3n_act", "s3n_full"])
def test_a_normalised_step_costs_no_more_than_a_serial_one(variant: str) -> None:
    model = load_model("leg")

    def stepping(name: str) -> Callable[[], None]:
        m = normalise(model, name).mujoco
        data = mujoco.MjData(m)

        def steps() -> None:
            mujoco.mj_resetData(m, data)
            mujoco.mj_step(m, data, 2000)

        return steps

    assert times_as_long(stepping(variant), stepping("kin_only"), 15).median < 1.3  # 1.03 to 1.06


def test_a_recording_is_read_nearly_as_fast_as_its_table(tmp_path: Path) -> None:
    save_recording(VirtualLeg(seed=1).run([chirp("knee", duration=5.0)])[0], tmp_path / "run.toml")
    (table,) = tmp_path.glob("*.csv.gz")
    read = lambda: pacsv.read_csv(BytesIO(gzip.decompress(table.read_bytes())))  # noqa: E731
    assert times_as_long(lambda: load_recording(tmp_path / "run.toml"), read).median < 3.0  # 1.5
