# %% [markdown]
# # From a robot's MJCF and a CSV to a verdict: what does it take?
#
# The arm of the tutorial: an MJCF file from its drawings, and two logs in milliseconds and degrees.
# Nothing else is said. (The logs come from equations of motion that share no code with this project.)

# %%
from pathlib import Path

import workbench as wb
from workbench import report
from workbench.core import Recording
from workbench.models import AppliedEffect
from workbench.proposing import Answers, complete, open_table, propose

FOLDER = Path(wb.__file__).parents[1] / "docs" / "tutorial"
arm = wb.load_model(FOLDER / "arm.xml")


def recording(name: str) -> Recording:
    """What the wizard makes of a log; it has no question here."""
    table = open_table(FOLDER / name)
    answers = Answers(model_axes=arm.axes)
    proposal = propose(table, answers)
    assert not proposal.questions
    return complete(proposal, table, answers)[1]


sweep, check = recording("sweep.csv"), recording("check.csv")
print(sweep.axes, sweep.controller)

# %% [markdown]
# Are the data sound, and does the model explain them?

# %%
assert wb.inspect([sweep, check]).sound
before = wb.compare(arm, [sweep, check])
report.print_table(report.compare_table(before))

# %%
diagnosis = wb.diagnose(arm, [sweep], [check])
report.print_table(report.diagnosis_table(diagnosis))
found = diagnosis.findings[0]
best = AppliedEffect(found.key, found.parameters)
after = wb.compare(arm.with_effect(best), [sweep, check])
figure = report.overlay_figure(before, "elbow", after=after)
figure

# %% [markdown]
# **Answer.** Two files, and no line about columns, units or gains. The elbow has dry friction that the
# drawings do not show, and with it the model explains the logs to the noise.

# %%
assert (best.key.effect, best.key.axis) == ("coulomb_friction", "elbow")
assert abs(best.parameters["torque"].value - 0.3) < 0.01
assert after.consistent and before.error > 4 * before.noise_error
