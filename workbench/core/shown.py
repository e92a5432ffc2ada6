"""What a notebook shows of a value: a few lines of HTML, and a picture."""

from __future__ import annotations

from importlib import import_module
from typing import Any


class Shown:
    """A value that notebooks show.

    How, is said by a module that is loaded by its name and only then: values know nothing of pages.
    """

    _shown_by = "workbench.report.notebook"

    def _repr_html_(self) -> str:
        return import_module(self._shown_by).as_html(self)

    def plot(self, **options: Any) -> Any:
        """A matplotlib figure of what matters most; `options` are those of the module's ``as_figure``."""
        return import_module(self._shown_by).as_figure(self, **options)
