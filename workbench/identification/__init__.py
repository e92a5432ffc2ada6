"""Actuator and leg parameters from frequency responses (paper, Algorithm 1)."""
