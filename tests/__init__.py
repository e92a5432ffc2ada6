"""Tests, one folder for each package of the workbench."""

import os

# Our matrices are small; BLAS threads only wait for each other where tests run side by side.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
