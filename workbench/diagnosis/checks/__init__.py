"""What makes recordings and model contradict each other: units, signs, loops, torque that is logged late."""
