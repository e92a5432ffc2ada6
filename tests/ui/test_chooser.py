"""The list of recordings: folded where it is long, and what is not offered is said."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.data_helpers import write_recording

pytest.importorskip("panel")


@pytest.mark.parametrize(("count", "folded"), [(10, False), (11, True)])
def test_more_than_ten_recordings_fold_away(tmp_path: Path, count: int, folded: bool) -> None:
    from workbench.ui import Bench, Shelf
    from workbench.ui.chooser import Chooser
    from workbench.ui.live import Live

    for k in range(count):
        (tmp_path / f"r{k}").mkdir()
        write_recording(tmp_path / f"r{k}")
    (tmp_path / "broken.toml").write_text("axes = [")
    live = Live(Bench(Shelf.of(None, [], tmp_path), tmp_path), lambda act: act(), lambda wait, act: None)
    chooser = Chooser(live)
    assert chooser.boxes.visible is not folded and chooser.fold.visible is folded
    assert "broken.toml (is not TOML)" in "".join(
        str(part.object) for part in chooser.view if hasattr(part, "object")
    )
    if folded:
        assert chooser.fold.name == "Show the recordings (0 of 11 chosen)"
        chooser.fold.clicks += 1
        assert chooser.boxes.visible and chooser.fold.name.startswith("Hide")
    live.close()
