# %% [markdown]
# # Can an effect that nobody told us of be found?
#
# Dry friction is hidden in the knee's drive of the virtual leg, by code that the diagnosis does not share.
# The diagnosis gets two recordings and the nominal model. Which effect does it name, where, and how large?

# %%
import workbench as wb
from workbench import report
from workbench.models import AppliedEffect
from workbench.rigs import HiddenEffect, VirtualLeg, slow_sweep, validation

TRUTH = HiddenEffect("coulomb_friction", "knee", "actuator", {"torque": 0.25})
leg = VirtualLeg([TRUTH], seed=3)
(slow,), (judge,) = leg.run([slow_sweep()]), leg.run([validation(3)])
diagnosis = wb.diagnose(wb.load_model("leg"), [slow], [judge])

# %%
report.print_table(report.diagnosis_table(diagnosis))

# %% [markdown]
# With the finding in the model, the curves lie on each other:

# %%
found = diagnosis.findings[0]
best = AppliedEffect(found.key, found.parameters)
better = wb.load_model("leg").with_effect(best)
before, after = wb.compare(wb.load_model("leg"), [judge]), wb.compare(better, [judge])
figure = report.overlay_figure(before, "knee", after=after)
figure

# %% [markdown]
# **Answer.** Yes: by name, in its place, and within its interval.

# %%
torque = best.parameters["torque"]
assert (best.key.effect, best.key.axis) == ("coulomb_friction", "knee")
assert abs(torque.value - 0.25) < 3 * torque.std + 0.005
