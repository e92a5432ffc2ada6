"""Runs the notebooks and writes them with what they show, and without what differs from run to run.

python analyses/run_notebooks.py [notebooks/hidden_effect.ipynb ...]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbformat import NotebookNode

NOTEBOOKS = Path(__file__).resolve().parents[1] / "notebooks"
_SECONDS = 900  # for a cell


def main(arguments: list[str] | None = None) -> None:
    """Run each and write it anew."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("notebooks", nargs="*", type=Path, default=sorted(NOTEBOOKS.glob("*.ipynb")))
    for file in parser.parse_args(arguments).notebooks:
        notebook = executed(file)
        file.write_text(nbformat.writes(notebook) + "\n", encoding="utf-8")
        print(f"Wrote {file}.")


def executed(file: Path) -> NotebookNode:
    """The notebook as it is after all its cells have run in its folder.

    Raises:
        CellExecutionError: a cell raised an exception.
    """
    notebook = nbformat.read(file, as_version=4)
    NotebookClient(notebook, timeout=_SECONDS, resources={"metadata": {"path": str(file.parent)}}).execute()
    notebook.metadata = {  # no version of the Python that ran it
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    for cell in notebook.cells:
        cell.metadata = {}
        # what says how far a run is differs from run to run
        cell.outputs = [o for o in cell.get("outputs", ()) if o.get("name") != "stderr"]
        if cell.cell_type == "markdown":
            del cell["outputs"]
    return notebook


if __name__ == "__main__":
    main()
