"""From a slider's move to the curve that is drawn anew, in a real browser, with a minute of data.

    python -m benchmarks.slider --seconds 60 --moves 40

The virtual leg is recorded for so long with friction in its knee. `workbench ui` serves it with a model
that has half of that, and a headless Chromium presses keys on the slider. The page shows the stretch of time
that it opens with. A move ends in the first frame after the curve's data have changed. Exit code 1 where the
median is above the limit.
"""

from __future__ import annotations

import argparse
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from tests.ui.chrome import Chrome
from workbench.core import EffectKey, Estimate
from workbench.effects import check_effect, load_model
from workbench.models import AppliedEffect, write_model
from workbench.rigs import VirtualLeg, demo_experiments
from workbench.rigs.hidden import HiddenEffect

LIMIT_MS = 150.0
#: One move: a key on the slider, then the time [ms] until a frame after the curve's source has changed.
_MOVE = """new Promise((done, failed) => {
  const page = Bokeh.documents[0], models = [...page._all_models.values()];
  const sources = models.filter((m) => m.type === 'ColumnDataSource' && m.data.t && m.data.after);
  const handle = deep('.noUi-handle'), began = performance.now();
  const late = () => failed(new Error('no curve came')), stop = setTimeout(late, 20000);
  const sum = (x) => x.reduce((a, b) => a + (Number.isFinite(b) ? b : 0), 0);
  const drawn = () => sources.map((s) => sum(s.data.after)).join();
  const before = drawn();
  let seen = false;
  const changed = () => {
    if (seen || drawn() === before) return; // a curve that is sent again as it was is none
    seen = true;
    requestAnimationFrame(() => { clearTimeout(stop); done(performance.now() - began); });
  };
  for (const source of sources) source.connect(source.properties.data.change, changed);
  handle.focus();
  const key = { key: 'KEY', keyCode: CODE, bubbles: true, cancelable: true };
  handle.dispatchEvent(new KeyboardEvent('keydown', key));
})"""


def record(folder: Path, seconds: float) -> list[Path]:
    """A recording of the leg with friction in its knee, and the model with half of that."""
    rate = 1000
    slow = next(e for e in demo_experiments(0) if e.name == "slow")
    times = int(np.ceil(seconds * rate / len(slow.reference)))
    rows = int(seconds * rate)
    longer = replace(
        slow,
        reference=np.tile(slow.reference, (times, 1))[:rows],
        feedforward=np.tile(slow.feedforward, (times, 1))[:rows],
    )
    hidden = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.25})
    files = VirtualLeg((hidden,), seed=0).record_to(folder, [longer])
    model = load_model("leg")
    friction = AppliedEffect(EffectKey("coulomb_friction", "knee"), {"torque": Estimate(0.12, 0.0, "N*m")})
    write_model(model.with_effect(check_effect(model, friction)), folder / "half.toml")
    return [folder / "half.toml", *map(Path, files)]


def measure(folder: Path, seconds: float, moves: int) -> list[float]:
    """Times of moves [ms], the first few left out."""
    words = [sys.executable, "-m", "workbench.cli", "ui", *map(str, record(folder, seconds)), "--no-browser"]
    server = subprocess.Popen(words, cwd=folder, stdout=subprocess.PIPE, text=True, bufsize=1)
    assert server.stdout is not None
    try:
        address = re.search(r"http://127\.0\.0\.1:\d+/", server.stdout.readline())
        assert address is not None
        with Chrome(folder / "profile") as chrome:
            chrome.look(1280, 900)
            chrome.open(address[0])
            chrome.wait("document.documentElement.dataset.ready === 'yes'")
            chrome.wait("words().includes('the noise floor of')", 300)
            shown = "every('input[type=checkbox]').find((e) => e.ariaLabel?.startsWith('Show the '))"
            chrome.wait(shown)  # sliders of effects that the model came with
            chrome.ask(f"{shown}.click()")
            chrome.wait("deep('.noUi-handle')")
            times = []
            for k in range(moves + 3):
                key, code = ("ArrowRight", "39") if k % 2 == 0 else ("ArrowLeft", "37")
                time.sleep(0.2)  # what the last move sent is there
                times.append(float(chrome.ask(_MOVE.replace("KEY", key).replace("CODE", code))))
        return times[3:]
    finally:
        server.send_signal(signal.SIGINT)
        server.wait(30)


def main() -> None:
    """Prints median and 90th percentile."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--moves", type=int, default=40)
    parser.add_argument("--limit", type=float, default=LIMIT_MS)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        times = measure(Path(folder), asked.seconds, asked.moves)
    median, slow = statistics.median(times), float(np.quantile(times, 0.9))
    print(
        f"{asked.seconds:g} s of data, {len(times)} moves: median {median:.0f} ms, 90 % below {slow:.0f} ms"
    )
    sys.exit(1 if median > asked.limit else 0)


if __name__ == "__main__":
    main()
