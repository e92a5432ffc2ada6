"""The live workbench: a page in the browser, served to this machine only."""

from .bench import Bench
from .shelf import Shelf

__all__ = ["Bench", "Shelf"]
