"""Screening: what every effect would explain, from one linearisation, before anything is fitted."""
