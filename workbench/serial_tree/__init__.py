"""The serial tree in Pinocchio: inertia, gravity, Coriolis, Jacobians, regressor."""
