"""`evodesign` and `python -m evodesign`: the command line, with an answer to Ctrl-C before it is loaded."""

import sys

from evodesign.interrupts import INTERRUPTED, INTERRUPTS
from evodesign.streams import adapt_streams


def main() -> None:
    """Run a command.

    Raises:
        SystemExit: always, with its exit code.
    """
    INTERRUPTS.begin()
    adapt_streams()
    try:
        code = _exit_code()
        INTERRUPTS.end(code)
    except KeyboardInterrupt:  # between the end of the command and that of this function
        code = INTERRUPTS.code
    raise SystemExit(code)


def _exit_code() -> int:
    from evodesign.cli.main import main as command

    try:
        INTERRUPTS.work()
        command()
    except SystemExit as left:
        if left.code != INTERRUPTED:  # typer's, for Ctrl-C
            return left.code if isinstance(left.code, int) else 0
    except BaseException:
        if not INTERRUPTS.unwinding:  # an import that is broken off has errors of its own
            raise
    sys.stderr.write(f"{INTERRUPTS.sentence}\n")
    return INTERRUPTS.code


if __name__ == "__main__":
    main()
