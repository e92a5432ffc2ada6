"""The version of the workbench; `pyproject.toml` reads it from here.

It is stated in the code and not asked of the installed package: on an index the package has another name.
"""

VERSION = "1.0.0"
