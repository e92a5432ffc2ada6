"""Arguments in, calls out; no logic."""

from .app import main

__all__ = ["main"]
