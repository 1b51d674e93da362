"""The stop button of a real notebook kernel, pressed during a search with workers."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from jupyter_client.blocking.client import BlockingKernelClient
from jupyter_client.kernelspec import KernelSpec
from jupyter_client.manager import KernelManager

from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.runlog.run import read_run


class ThisPython(KernelManager):
    @property
    def kernel_spec(self) -> KernelSpec:
        command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
        return KernelSpec(argv=command, display_name="tests", language="python")


@pytest.fixture
def kernel(known: Precomputed) -> Iterator[tuple[ThisPython, BlockingKernelClient]]:
    assert known.postures, "worked out before, so that no search has to"
    manager = ThisPython()
    manager.start_kernel()
    client = manager.blocking_client()
    client.start_channels()
    client.wait_for_ready(timeout=300)
    yield manager, client
    client.stop_channels()
    manager.shutdown_kernel(now=True)


def wait_for_line(client: BlockingKernelClient, line: str) -> None:
    """Wait until the cell at work prints a line; an error of it is the test's."""
    while True:
        message = client.get_iopub_msg(timeout=300)
        content = message["content"]
        assert message["msg_type"] != "error", "\n".join(content["traceback"])
        if content.get("name") == "stdout" and line in content["text"].splitlines():
            return


def error_of(client: BlockingKernelClient, request: str) -> dict[str, Any]:
    """The error that a cell ended with, as the notebook shows it; nothing of one that ended well."""
    error: dict[str, Any] = {}
    while True:
        message = client.get_iopub_msg(timeout=300)
        if message["parent_header"].get("msg_id") == request:
            if message["msg_type"] == "error":
                error = message["content"]
            if message["content"].get("execution_state") == "idle":
                return error


@pytest.mark.slow
def test_the_stop_button_leaves_a_run_that_the_next_cell_resumes(
    kernel: tuple[ThisPython, BlockingKernelClient], tmp_path: Path
) -> None:
    manager, client = kernel
    place = tmp_path / "run"
    cell = (
        "import evodesign\n"
        f"run = evodesign.search('point-grasp', {str(place)!r}, population=4, evaluations=4000, jobs=2,\n"
        "    callback=lambda event: print('one'))"
    )
    # a kernel drops, for a moment, what is asked after an error; people press no faster
    request = client.execute(cell, stop_on_error=False)
    wait_for_line(client, "one")
    manager.interrupt_kernel()
    stopped = error_of(client, request)
    # on a busy machine the kernel was once seen to end the cell with an error of its own
    assert stopped["ename"] in ("Interrupted", "KeyboardInterrupt"), "\n".join(stopped["traceback"])
    assert stopped["ename"] != "Interrupted" or f"evodesign resume {place}" in stopped["evalue"]
    known = len(read_run(place).evaluations)
    assert 1 <= known < 400
    again = client.execute(f"evodesign.resume({str(place)!r}, evaluations={known + 3}, jobs=2)")
    assert error_of(client, again) == {}
    assert len(read_run(place).evaluations) == known + 3
