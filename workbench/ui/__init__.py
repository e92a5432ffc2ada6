"""The live workbench: a page in the browser, served to this computer only."""

from .bench import Bench
from .shelf import Shelf

__all__ = ["Bench", "Shelf"]
