# %% [markdown]
# # How much of a real drive does a bare mass explain?
#
# EMPS is a measured linear drive, a benchmark of Janot, Gautier and Brunot. The model is a mass and
# nothing else. What do the data add, and how good does it get? (`WORKBENCH_DATA` names the folder that
# holds `emps`.)

# %%
import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import workbench as wb
from workbench import report

ROOT = Path(wb.__file__).parents[1]
sys.path.insert(0, str(ROOT / "analyses"))
from emps import description

table = Path(os.environ.get("WORKBENCH_DATA", ROOT.parent / "shared" / "data")) / "emps" / "DATA_EMPS.mat"
with TemporaryDirectory() as folder:
    file = Path(folder) / "emps.toml"
    file.write_text(description(table))
    recordings = wb.load_recordings(file)
result, better = wb.improve(wb.load_model("emps"), recordings)

# %%
report.print_table(report.improvement_table(result))
figure = report.ladder_figure(result)
figure

# %% [markdown]
# **Answer.** Friction, dry and viscous, is nearly all of the rest. The force that the better model needs
# for the motion is off by less than the 3.1 % that the benchmark's authors reach; what is left is above
# the noise, and said to be.

# %%
assert result.error_after < 0.3 * result.error_before
dynamics = wb.compare(better, recordings).inverse_dynamics
assert dynamics is not None and dynamics.relative_error < 0.031
