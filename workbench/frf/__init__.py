"""Frequency responses: excitation, estimation with uncertainty, parametric fits."""
