# %% [markdown]
# # How much inertia does a serial leg leave out?
#
# A parallel leg simulated as a serial tree with Jacobian mapping (Kin-Only) moves as if its drives sat on the
# joints and its linkage weighed nothing. S3N puts both back, first the drives (S3N-Act), then the linkage
# (S3N-Full). How large is each term, at which posture, and what does it do to the acceleration?

# %%
import sys
from pathlib import Path

import numpy as np

import workbench as wb
from workbench import report
from workbench.s3n.gap import inertia_gap
from workbench.verification import verify

sys.path.insert(0, str(Path(wb.__file__).parents[1] / "analyses"))
from inertia_gap import gap_figure, papers_table, terms_table

leg = wb.load_model("leg")
gap = inertia_gap(leg, np.radians(np.linspace(0.0, 180.0, 91)))

# %% [markdown]
# At 90 degrees, the numbers of the method's own table:

# %%
report.print_table(papers_table(leg))

# %% [markdown]
# Over the knee angle: the drives' share is constant, the linkage's shrinks as the knee folds.

# %%
report.print_table(terms_table(gap))
figure = gap_figure(gap)
figure

# %% [markdown]
# Are these numbers right? The closed chain in Drake, the tree in Pinocchio and MuJoCo and the closed forms
# have to agree.

# %%
checked = verify(leg, samples=20)
report.print_table(report.verification_table(checked))

# %% [markdown]
# **Answer.** More than half of what is missing are the drives themselves, behind the transmission. Under the
# same torque, Kin-Only accelerates more than twice as fast as the leg in the worst direction (hip and knee
# turning the same way, so that the knee's drive turns with both), at every posture: no posture hides it.

# %%
assert checked.passed
assert gap.actuator_share.min() > 0.5
assert gap.too_fast.min() > 1.0
assert (gap.worst[:, 0] * gap.worst[:, 1] > 0.0).all()
