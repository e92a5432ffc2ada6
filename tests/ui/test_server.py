from __future__ import annotations

import subprocess
import sys
from pathlib import Path

#: An exception that a signal raises in a weak reference's callback is printed and lost.
_SCRIPT = """
import os, signal, weakref
from pathlib import Path
from workbench.cli import main
from workbench.ui import server

class Thing: pass

def interrupt(_):
    os.kill(os.getpid(), signal.SIGINT)
    sum(range(1000))

serve = server.serve
def serving(bench, port, ready):
    def told(address):
        thing = Thing()
        watch = weakref.ref(thing, interrupt)
        del thing
    serve(bench, port, told)
server.serve = serving
import sys
sys.argv = ["workbench", "ui", "--no-browser"]
main()
"""


def test_one_interrupt_ends_it_wherever_it_strikes(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _SCRIPT], cwd=tmp_path, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 130, done.stderr
    assert done.stderr.strip() == ""
