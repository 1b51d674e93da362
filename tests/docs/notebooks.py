"""Runs the notebooks: `python -m tests.docs.notebooks` stores their outputs in them, after a change."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import nbformat
from jupyter_client.kernelspec import KernelSpec
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient

NOTEBOOKS = sorted((Path(__file__).parents[2] / "docs" / "notebooks").glob("*.ipynb"))


class ThisPython(AsyncKernelManager):
    """Starts kernels with the Python that runs the tests, whatever kernels the machine knows."""

    @property
    def kernel_spec(self) -> KernelSpec:
        command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
        return KernelSpec(argv=command, display_name="tests", language="python")


def executed(notebook: Path) -> Any:
    """The notebook with the outputs that it has now; a cell that fails raises."""
    book = nbformat.read(notebook, as_version=4)
    metadata = dict(book.metadata)
    client = NotebookClient(
        book,
        timeout=1200,
        record_timing=False,
        kernel_manager_class=ThisPython,
        resources={"metadata": {"path": str(notebook.parent)}},
    )
    client.execute()
    book.metadata = metadata  # the kernel adds the version of this Python
    return book


def store(notebook: Path) -> None:
    """Execute a notebook and store it with its outputs, without warnings of packages on this machine."""
    book = executed(notebook)
    for cell in book.cells:
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if output.get("name") != "stderr"]
    nbformat.write(book, notebook)


if __name__ == "__main__":
    for notebook in NOTEBOOKS:
        store(notebook)
