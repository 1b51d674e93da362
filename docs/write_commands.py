"""Writes the options of docs/commands.md from the command line itself: `python -m docs.write_commands`."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import typer

from docs.write_actuators import table
from evodesign.cli.main import COMMANDS, app

PAGE = Path(__file__).parent / "commands.md"
BEGIN, END = "<!-- options -->\n", "<!-- end of options -->\n"


def options() -> str:
    """A section for each command: what it does, its arguments and options."""
    known = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    return "\n".join(_section(name, known[name]) for name in COMMANDS)


def _section(name: str, command: Any) -> str:
    parameters = [each for each in command.params if each.help]
    rows = ((_written(each), _default(each), each.help) for each in parameters)
    paragraphs = "\n\n".join(" ".join(each.split()) for each in command.help.split("\n\n"))
    return f"### {name}\n\n{paragraphs}\n\n{table(('argument or option', 'default', 'what it is'), rows)}"


def _written(parameter: Any) -> str:
    """A parameter as it is typed."""
    metavar = re.sub(r"[\[\]{}]|\s*<.*>", "", parameter.metavar or parameter.name.upper())
    if parameter.param_type_name == "argument":
        return f"`{metavar}`"
    names = "`, `".join((*parameter.opts, *parameter.secondary_opts))
    return f"`{names}`" if parameter.is_flag else f"`{names} {metavar}`"


def _default(parameter: Any) -> str:
    """What holds without it, in words."""
    if parameter.required:
        return "required"
    if isinstance(parameter.show_default, str):
        return parameter.show_default
    value = parameter.default
    return "" if value is None or isinstance(value, bool | tuple | list) or callable(value) else f"{value}"


def page() -> str:
    """The page with the options of today."""
    before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    return f"{before}{BEGIN}\n{options()}\n{END}{rest.split(END)[1]}"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
