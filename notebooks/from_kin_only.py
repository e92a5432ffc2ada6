# %% [markdown]
# # What does a serial model of a parallel leg lack, and in which order?
#
# The model starts with nothing but the Jacobian right (Kin-Only). The virtual leg, a closed chain, shows
# where it fails. Each step below is found in the recordings, added, and judged by one that was not fitted.

# %%
import workbench as wb
from workbench import report
from workbench.rigs import VirtualLeg, multisine, slow_sweep, validation

short = [multisine(mode, period=2.0, duration=4.0) for mode in ("sum", "difference")]
recordings = VirtualLeg(seed=0).run([*short, slow_sweep(duration=6.0)])
judge = VirtualLeg(seed=1).run([validation(1, duration=3.0)])
result, better = wb.improve(wb.load_model("leg_kin_only"), recordings, judge)

# %%
report.print_table(report.improvement_table(result))
figure = report.ladder_figure(result)
figure

# %% [markdown]
# **Answer.** First the drives behind the transmission, then the linkage: the steps of S3N, found from
# recordings alone. After them the error is the noise.

# %%
found = [step.key.effect for step in result.steps]
assert found[0] == "actuator_inertia_coupling"
assert "linkage_inertia" in found
assert result.error_after < 1.2 * result.noise_error
