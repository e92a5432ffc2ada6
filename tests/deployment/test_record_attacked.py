"""The recorder on a disk that fails at any moment: what was there before, or all that is new, and a line."""

from __future__ import annotations

import errno
import os
import threading
from pathlib import Path

import pytest

from tests.deployment.test_record import actuator, design
from tests.disk import files, sweep
from workbench.can.candump import read_candump
from workbench.core import InputError, WorkbenchError
from workbench.core.unfinished import finish
from workbench.deployment import logger
from workbench.deployment.network import Arrival
from workbench.deployment.record import keep, record_simulated
from workbench.recordings import load_recording


@pytest.mark.parametrize("force", [False, True])
def test_a_disk_that_fails_at_any_call_leaves_old_or_new(tmp_path: Path, force: bool) -> None:
    loaded = actuator(tmp_path)
    old, new = (record_simulated(loaded, design(rms=rms), 0, tmp_path / f"{rms}.log") for rms in (2.0, 3.0))
    for disk in sweep(tmp_path):
        folder = disk.folder
        if force:
            keep(old, folder, tmp_path / "2.0.log", force=False)
        before, error = files(folder), None
        with disk:
            try:
                keep(new, folder, tmp_path / "3.0.log", force=force)
            except WorkbenchError as caught:
                error = caught
        finish(folder)  # what was complete is put into its places by whoever reads there next
        after = files(folder)
        assert error is None or (error.exit_code != 0 and "m." in str(error))
        if error is None or after != before:
            assert set(after) == {"m.toml", "m.csv.gz", "m.blf"}
            assert load_recording(folder / "m.toml").position == pytest.approx(new.position)


def test_a_log_on_a_full_disk_has_whole_lines_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from workbench.can import Frame

    arrivals = [Arrival("can0", 0.001 * k, Frame(0x11, bytes(8))) for k in range(50)]

    class Network:
        gone = False

        def __init__(self, *args: object, **more: object) -> None: ...

        def receive(self, until: float) -> list[Arrival]:
            return arrivals

        def close(self) -> None: ...

    monkeypatch.setattr(logger, "PortNetwork", Network)
    written, real = [0], os.write

    def short(file: int, data: bytes) -> int:
        """At most 100 bytes at once, and nothing beyond 20 kB."""
        part = data[: min(100, 20_000 - written[0])]
        if not part:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written[0] += len(part)
        return real(file, part)

    monkeypatch.setattr(os, "write", short)
    with pytest.raises(InputError, match=r"run\.log: cannot be written \(No space left"):
        logger.log_buses(actuator(tmp_path), tmp_path / "run.log", lambda: threading.active_count() == 0)
    frames = list(read_candump(tmp_path / "run.log"))
    assert len(frames) > 300 and all(each.frame.id == 0x11 for each in frames)
