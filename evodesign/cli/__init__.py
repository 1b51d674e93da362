"""The command line: `evodesign COMMAND`.

Results go to standard output, progress and errors to standard error. Exit codes: 0 done, 2 bad input (one
sentence), 3 stopped but resumable, 130 stopped with nothing to resume.
"""

from evodesign.cli.main import main

__all__ = ["main"]
