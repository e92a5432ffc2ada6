"""The circular task with a load that differs from world to world; the test is the lap with 4 kg.

    workbench train analyses/payload_lap.py --variant s3n_full --unverified -o runs/payload

Policies carry the text of this file: whoever changes it trains them again.
"""

from dataclasses import replace

from workbench.training.tasks import CIRCULAR

TASK = replace(
    CIRCULAR,
    name="payload",
    about="The robot runs at commanded velocities under loads of up to 5 kg; the test is a lap with 4 kg.",
    trunk_mass=(-0.5, 5.0),
    iterations=800,
)
