"""``python -m workbench.cli``."""

from .app import main

main()
