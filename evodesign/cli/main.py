"""The command line: registers the commands and turns errors into exit codes.

What a command needs is imported when it is called: showing a front must not wait for CasADi to load.
"""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Callable
from importlib.metadata import version
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from evodesign.cli.baseline import baseline
from evodesign.cli.branch import branch
from evodesign.cli.carry import carry
from evodesign.cli.check import check
from evodesign.cli.compare import compare
from evodesign.cli.evaluate import evaluate
from evodesign.cli.export import export
from evodesign.cli.families import families
from evodesign.cli.front import front
from evodesign.cli.init import init
from evodesign.cli.lift import lift
from evodesign.cli.matters import matters
from evodesign.cli.merge import merge
from evodesign.cli.options import BAD_INPUT, NOTHING_SOLVED
from evodesign.cli.polish import polish
from evodesign.cli.problems import problems
from evodesign.cli.push import push
from evodesign.cli.recover import recover
from evodesign.cli.report import report
from evodesign.cli.reproduce import reproduce
from evodesign.cli.resume import resume
from evodesign.cli.schema import schema
from evodesign.cli.search import search
from evodesign.cli.show import show
from evodesign.cli.simulate import simulate
from evodesign.cli.spread import spread
from evodesign.cli.starts import starts
from evodesign.cli.validate import validate
from evodesign.cli.verify import verify
from evodesign.cli.watch import watch
from evodesign.errors import AllFailed, EvodesignError, InputError, Interrupted
from evodesign.interrupts import STOPPED
from evodesign.streams import UNREAD

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)

COMMANDS: dict[str, Callable[..., None]] = {
    "search": search,
    "resume": resume,
    "branch": branch,
    "front": front,
    "report": report,
    "show": show,
    "export": export,
    "watch": watch,
    "compare": compare,
    "matters": matters,
    "families": families,
    "spread": spread,
    "evaluate": evaluate,
    "lift": lift,
    "simulate": simulate,
    "push": push,
    "carry": carry,
    "polish": polish,
    "check": check,
    "problems": problems,
    "init": init,
    "schema": schema,
    "starts": starts,
    "validate": validate,
    "verify": verify,
    "recover": recover,
    "merge": merge,
    "baseline": baseline,
    "reproduce": reproduce,
}


class WholeHelp(TyperGroup):
    """A list of commands that does not cut off what is said of each."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Each command with all of its first sentence."""
        rows = [
            (name, self.commands[name].get_short_help_str(limit=1000)) for name in self.list_commands(ctx)
        ]
        with formatter.section("Commands"):
            formatter.write_dl(rows)


class NothingEmpty(TyperCommand):
    """A command that takes no empty word for a path, which would be the working directory, or for a name."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse, after a look at what each parameter was given.

        Raises:
            typer.BadParameter: nothing but two quotation marks.
        """
        given, _, _ = self.make_parser(ctx).parse_args(args=[*args])
        parameters: list[Any] = [*self.get_params(ctx)]
        for parameter in parameters:
            value = given.get(parameter.name or "")
            if "" in (value if isinstance(value, list | tuple) else [value]):
                raise typer.BadParameter("wanted a path or a word, found ''", ctx, parameter)
        return super().parse_args(ctx, args)


app = typer.Typer(
    name="evodesign",
    cls=WholeHelp,
    help="Humanoid robots designed by evolution for low joint torques of robot and person who hold a load.",
    no_args_is_help=True,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
)
for name, command in COMMANDS.items():
    app.command(name, cls=NothingEmpty)(command)


def _show_version(asked: bool) -> None:
    if asked:
        sys.stdout.write(f"evodesign {version('evodesign')}\n")
        raise typer.Exit


@app.callback()
def _app(
    _version: Annotated[
        bool,
        typer.Option("--version", help="Show the version and exit.", is_eager=True, callback=_show_version),
    ] = False,
) -> None: ...


def main() -> None:
    """Run a command; errors that evodesign knows end it with one sentence."""
    try:
        try:
            app(prog_name="evodesign")
        finally:
            sys.stdout.flush()
    except Interrupted as stop:
        _leave(f"{stop}", STOPPED)
    except AllFailed as failure:
        _leave(f"error: {failure}", NOTHING_SOLVED)
    except EvodesignError as error:
        _leave(f"error: {error}", BAD_INPUT)
    except UnicodeEncodeError as error:  # a path of bytes that are no text, which a log cannot hold
        wanted = "names of files that are text in this locale (with PYTHONUTF8=1: in UTF-8)"
        _leave(f"error: {InputError('a path', '', wanted, repr(error.object))}", BAD_INPUT)
    except SystemExit as left:
        if isinstance(left.__context__, BrokenPipeError):  # typer makes a code of its own of it
            raise SystemExit(UNREAD) from None
        raise
    except BrokenPipeError:
        _drop_output()
        raise SystemExit(UNREAD) from None
    except OSError as error:
        if error.errno not in NO_ROOM:
            raise
        _drop_output()
        _leave(f"error: the output cannot be written: {error.strerror}", BAD_INPUT)


def _drop_output() -> None:
    """Let what is left of standard output go nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _leave(sentence: str, code: int) -> None:
    from evodesign.cli.output import print_lines

    print_lines(sentence, stderr=True)
    raise SystemExit(code)
