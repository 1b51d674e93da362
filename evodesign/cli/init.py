"""`init`: a problem file for a robot of one's own."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer


def init(
    robot: Annotated[Path, typer.Argument(metavar="ROBOT", help="URDF or MJCF of a humanoid robot.")],
    to: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="The new problem file.", show_default="name of ROBOT, in this directory"
        ),
    ] = None,
) -> None:
    """Write a problem file for a robot, and say what was guessed and why.

    Heading, hands, soles, trunk, joints and design parameters come from the robot's geometry. What cannot be
    guessed is FILL IN in the file. The schema beside it lets editors check and complete it.
    """
    from evodesign.cli.output import console, print_commands, show_notes, write_text
    from evodesign.cli.tables.table import names, titled
    from evodesign.errors import InputError
    from evodesign.files import is_there
    from evodesign.guess.problem_text import guessed_problem, inertia_rule
    from evodesign.problem.meshes import with_meshes_beside
    from evodesign.problem.named_files import read_robot
    from evodesign.problem.schema import SCHEMA_FILE, schema_file, with_schema_line
    from evodesign.problem.table import FILL_IN
    from evodesign.tree.urdf_read import InertiaRule, read_urdf

    file = to or Path(f"{robot.stem}.toml")
    if is_there(file):
        raise InputError("--to", "", "a new file", f"'{file}', which exists")
    model = read_robot(robot, str(robot), "ROBOT", "")
    tree = read_urdf(model.urdf, str(robot), InertiaRule.AUTO)
    tree = read_urdf(model.urdf, str(robot), inertia_rule(tree))
    urdf = Path(os.path.relpath(robot.resolve(), file.resolve().parent)).as_posix()
    tree = with_meshes_beside(tree, robot, model)
    guessed = guessed_problem(tree, urdf)
    write_text(file, with_schema_line(guessed.text), "--to")
    write_text(file.parent / SCHEMA_FILE, schema_file(), "--to")
    show_notes(tree.notes)
    rows = ((guess.key, guess.found or FILL_IN, guess.why) for guess in guessed.guesses)
    console().print(titled("guessed", names("key", "guess", "because"), rows))
    print_commands(f"evodesign check {file}", f"evodesign evaluate {file}", f"evodesign search {file}")
