"""Malformed files made from valid ones, and what the readers make of them."""
