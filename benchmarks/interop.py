"""What `normalize --for` writes, loaded by what reads it: one torque trace replayed there and in MuJoCo 4.

python benchmarks/interop.py mujoco3 --python build/interop/mujoco3/bin/python    # `make interop` makes
that environment

The other environment needs the simulator and numpy alone; this script runs itself there (``--replay``).
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

MODELS = "leg", "four_bar"
_ROWS, _STEP = 600, 0.001  # s
_ALLOWED = 1e-3  # of the largest way that a joint goes: what another version's order of operations makes


def replay(file: Path, torque: np.ndarray) -> np.ndarray:
    """Positions (N, nq) of a file under torques (N, nu) of its motors, in whatever MuJoCo is installed."""
    import mujoco

    m = mujoco.MjModel.from_xml_path(str(file))
    m.opt.timestep = _STEP
    data, out = mujoco.MjData(m), np.zeros((len(torque), m.nq))
    data.qpos[:] = _start(m)
    for k, row in enumerate(torque):
        out[k] = data.qpos
        data.ctrl[:] = row
        mujoco.mj_step(m, data)
    return out


def _start(m: object) -> np.ndarray:
    """The middle of the joints' ranges, or where the file begins."""
    ranges = np.array(m.jnt_range)  # pyright: ignore[reportAttributeAccessIssue]
    return np.where(np.ptp(ranges, axis=1) > 0.0, ranges.mean(axis=1), m.qpos0)  # pyright: ignore


def compare(target: str, python: str) -> bool:
    """Writes, replays on both sides and tells; whether all agree."""
    from workbench.models import read_model
    from workbench.s3n import fit_native, normalise
    from workbench.s3n.targets import TARGETS

    good = True
    with tempfile.TemporaryDirectory() as folder:
        for name in MODELS:
            model = read_model(name)
            tree = fit_native(model) if model.posture_dependent else normalise(model, "exact")
            fitted = TARGETS[target](tree.xml)
            file, trace, made = (Path(folder) / f"{name}{end}" for end in (".xml", ".npy", "_there.npy"))
            file.write_text(fitted.text)
            time = _STEP * np.arange(_ROWS)
            torque = np.stack(
                [0.8 * np.sin(2 * np.pi * (1.0 + 0.7 * k) * time) for k in range(model.size)], axis=1
            )
            np.save(trace, torque)
            words = [python, str(Path(__file__).resolve()), "--replay", str(file), str(trace), str(made)]
            done = subprocess.run(words, capture_output=True, text=True, check=False)
            if done.returncode:
                print(f"{name} for {target}: not read: {done.stderr.strip().splitlines()[-1]}")
                good = False
                continue
            there, here = np.load(made), replay(file, torque)
            way = float(np.ptp(here, axis=0).max())
            off = float(np.abs(there - here).max())
            fine = there.shape == here.shape and off <= _ALLOWED * way
            good &= fine
            print(
                f"{name} for {target} ({done.stdout.strip()}): off by {off:.2g} rad of {way:.3g}"
                f"{'' if fine else ': too much'}; lost: {'; '.join(fitted.lost) or 'nothing'}"
            )
    return good


def main() -> None:
    """Compares, or replays for another process that does."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("target", nargs="?", default="mujoco3")
    parser.add_argument("--python", default=sys.executable, help="of the environment that has the simulator")
    parser.add_argument("--replay", nargs=3, type=Path, metavar=("FILE", "TORQUE", "OUT"))
    asked = parser.parse_args()
    if asked.replay:
        import mujoco

        file, trace, out = asked.replay
        np.save(out, replay(file, np.load(trace)))
        print(f"MuJoCo {mujoco.__version__}")
        return
    sys.exit(0 if compare(asked.target, asked.python) else 1)


if __name__ == "__main__":
    main()
