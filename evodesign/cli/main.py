"""The commands' one door: registers them and turns errors into exit codes."""

from __future__ import annotations

import sys

import typer

from evodesign.cli.commands import COMMANDS
from evodesign.errors import EvodesignError, Interrupted

__all__ = ["app", "main"]

BAD_INPUT, STOPPED = 2, 3

app = typer.Typer(
    name="evodesign",
    help="Design humanoid robots by evolution, so that robot and person lifting together both strain less.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for command in COMMANDS:
    app.command()(command)


def main() -> None:
    """Run a command; errors that evodesign knows end it with one sentence."""
    try:
        app()
    except Interrupted as stop:
        _leave(f"{stop}", STOPPED)
    except KeyboardInterrupt:  # a search turns it into Interrupted as soon as there is a run
        _leave("stopped", STOPPED)
    except EvodesignError as error:
        _leave(f"error: {error}", BAD_INPUT)


def _leave(sentence: str, code: int) -> None:
    sys.stderr.write(sentence + "\n")
    raise SystemExit(code)
