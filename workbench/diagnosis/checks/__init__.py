"""Checks for contradictions between recordings and model: units, signs, loops, torque logged late."""
