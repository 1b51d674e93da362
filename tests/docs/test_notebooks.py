"""The example notebooks run from the first cell to the last, and show what they give."""

from __future__ import annotations

import getpass
import json
import re
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
import pytest

from evodesign.posture.precompute.precomputed import Precomputed
from tests.docs.notebooks import NOTEBOOKS, executed

pytestmark = pytest.mark.slow

ABSOLUTE = re.compile(r"(?<![\w.:/<])/[\w.-]+/[\w.-]+|\b[A-Z]:\\\\")
"""A place on somebody's machine."""


def outputs_of(notebook: Path) -> Iterator[Any]:
    for cell in nbformat.read(notebook, as_version=4).cells:
        yield from cell.get("outputs", ())


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs(notebook: Path, known: Precomputed) -> None:
    assert known.postures, "worked out before, so that the notebook finds it in the cache"
    book = executed(notebook)
    assert all(cell.get("execution_count") for cell in book.cells if cell.cell_type == "code")


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_is_stored_with_its_outputs(notebook: Path) -> None:
    """From one run, top to bottom; a cell without an output ends with a statement."""
    cells = [cell for cell in nbformat.read(notebook, as_version=4).cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    assert sum(bool(cell.outputs) for cell in cells) >= len(cells) - 1
    assert "error" not in {output.output_type for output in outputs_of(notebook)}
    assert "stderr" not in {output.get("name") for output in outputs_of(notebook)}


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_outputs_name_no_machine_and_are_small(notebook: Path) -> None:
    shown = json.dumps(list(outputs_of(notebook)), ensure_ascii=False)
    texts = re.sub(r'"image/png": "[^"]*"', "", shown)
    assert not ABSOLUTE.search(texts), ABSOLUTE.findall(texts)
    for name in (getpass.getuser(), socket.gethostname()):
        assert not re.search(rf"\b{re.escape(name)}\b", texts), name
    assert notebook.stat().st_size < 100_000


@pytest.mark.parametrize(
    "text",
    ["in /tmp/x/small: 18 evaluations", "'/home/somebody/runs'", r"C:\\Users\\somebody", "=/root/.cache"],
)
def test_places_on_a_machine_are_recognised(text: str) -> None:
    assert ABSOLUTE.search(text)


def test_there_are_two_notebooks() -> None:
    assert len(NOTEBOOKS) == 2
