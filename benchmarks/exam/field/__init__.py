"""Families of cases like those of the field: robots that are no leg with rods, with a simulator of their own.

An `arm` of three axes (yaw, lift, bend), one leg of a `quadruped` (abduction, thigh, calf) that logs
positions alone, an arm of six axes (`six_axis`) and a `cart` with a rod that no motor drives. Numbers,
motions and noise are drawn from the case's seed; the model is an MJCF file that differs from the machine in
what the case says. Kinds:

- ``clean``: the model is the machine.
- ``wrong_number``: one number of the file is not the machine's, too much or too little: damping,
  frictionloss, armature, the centre of mass of a link, or its inertia about its hinge.
- ``positions_alone``: the same, of references and positions at 50 to 200 Hz of a loop at 1 kHz.
- ``beside_stranger``: the friction of all axes is missing, or one number is wrong, beside something that no
  catalogue has: a rough patch, a torque that goes with another axis, a tone in time.
- ``friction_everywhere``: the file has neither damping nor frictionloss.
- ``two_units``: one of several recordings has its torque in another unit, or was made with another load.

What is hidden is stated as a diagnosis would: the catalogue's effects, with what the model lacks (negative
where it says too much). Right is: each of these named at its axis or truly alike, each value within a tenth
of the machine's, nothing else named, and the verdict that is true of the rest. The simulator is
that of the exam's package and shares nothing with `workbench`: recursive Newton-Euler, Runge-Kutta, friction
that sticks.
"""
