"""Runs the notebooks of this folder; --write puts them back without outputs.

They are kept without outputs: a number in a notebook that nobody computes again is soon wrong.
"""

from __future__ import annotations

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

HERE = Path(__file__).resolve().parent


def main() -> None:
    """Runs all notebooks; a cell that fails ends the run."""
    paths = sorted(HERE.glob("*.ipynb"))
    if not paths:
        raise SystemExit("there are no notebooks")
    for path in paths if len(sys.argv) < 3 else [HERE / sys.argv[2]]:
        notebook = nbformat.read(path, as_version=4)
        kept = [cell for cell in notebook.cells if cell.cell_type == "code" and (cell.outputs or cell.execution_count)]
        if kept and "--write" not in sys.argv:
            raise SystemExit(f"{path.name} has outputs: run python/notebooks/run.py --write")
        NotebookClient(
            notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": str(HERE)}}
        ).execute()
        print(f"{path.name}: {sum(cell.cell_type == 'code' for cell in notebook.cells)} cells")
        if "--write" in sys.argv:
            for cell in notebook.cells:
                if cell.cell_type == "code":
                    cell.outputs, cell.execution_count = [], None
                cell.metadata = {}
            notebook.metadata = {"kernelspec": notebook.metadata["kernelspec"]}
            nbformat.write(notebook, path)


if __name__ == "__main__":
    main()
