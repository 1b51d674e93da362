"""Commands in the tests' own process: to start another takes longer than most of them do."""

from __future__ import annotations

import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO

import pytest

from evodesign.cli import main


def evodesign(*arguments: object) -> subprocess.CompletedProcess[str]:
    """What a command does, as if a process had done it."""
    command = ["evodesign", *map(str, arguments)]
    output, errors = StringIO(), StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(output), redirect_stderr(errors):
        patch.setattr(sys, "argv", command)
        with pytest.raises(SystemExit) as left:
            main()
    code = left.value.code
    return subprocess.CompletedProcess(command, int(code or 0), output.getvalue(), errors.getvalue())
