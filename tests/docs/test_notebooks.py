"""The example notebooks run from the first cell to the last."""

from __future__ import annotations

import sys
from pathlib import Path

import nbformat
import pytest
from jupyter_client.kernelspec import KernelSpec
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient

from evodesign.posture.precompute.precomputed import Precomputed

NOTEBOOKS = sorted((Path(__file__).parents[2] / "docs" / "notebooks").glob("*.ipynb"))


class ThisPython(AsyncKernelManager):
    """Starts kernels with the Python that runs the tests, whatever kernels the machine knows."""

    @property
    def kernel_spec(self) -> KernelSpec:
        command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
        return KernelSpec(argv=command, display_name="tests", language="python")


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs(notebook: Path, known: Precomputed, tmp_path: Path) -> None:
    assert known.values, "worked out before, so that the notebook finds it in the cache"
    book = nbformat.read(notebook, as_version=4)
    client = NotebookClient(
        book,
        timeout=240,
        kernel_manager_class=ThisPython,
        resources={"metadata": {"path": str(notebook.parent)}},
    )
    client.execute()
    assert all(cell.get("execution_count") for cell in book.cells if cell.cell_type == "code")


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_is_kept_without_outputs(notebook: Path) -> None:
    for cell in nbformat.read(notebook, as_version=4).cells:
        assert not cell.get("outputs")
        assert cell.get("execution_count") is None


def test_there_are_two_notebooks() -> None:
    assert len(NOTEBOOKS) == 2
