"""Arguments in, calls out; no logic."""

from __future__ import annotations

import os
import signal
import sys
import warnings


def main() -> None:
    """Run the command line; an interrupt ends it quietly, even while it is still loading."""
    # until something may be written, an interrupt simply ends the process, without a traceback of imports
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.SIG_IGN:  # as in the background
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    # many small factorisations: the threads of a linear algebra library only get in each other's way; and how
    # many add up a long sum changes its last digit, so nobody's setting may choose
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    # nothing is drawn by MuJoCo here, which would load a window library and start a process to look at it
    os.environ.setdefault("MUJOCO_GL", "disable")
    from .app import run

    signal.signal(signal.SIGINT, before)
    # numbers beyond all bounds end as an answer or an error of our own; where they arose helps nobody here
    warnings.filterwarnings("ignore", category=RuntimeWarning)
    try:
        run()
    except KeyboardInterrupt:
        _interrupted()
    except RuntimeError as error:
        # what interrupts the making of a class, as in an import, comes wrapped in such an error
        if not isinstance(error.__cause__, KeyboardInterrupt):
            raise
        _interrupted()


def _interrupted() -> None:
    print("interrupted", file=sys.stderr)
    sys.exit(130)


__all__ = ["main"]
