"""`check`: a problem as it was understood."""

from __future__ import annotations

from evodesign.cli.options import Json, ProblemPath

__all__ = ["check"]


def check(problem: ProblemPath, json: Json = False) -> None:
    """Read a problem and show what was understood: agents, load, task, and what each parameter changes."""
    from evodesign.cli.output import console, print_json, show_notes
    from evodesign.cli.tables.problem import model_tables
    from evodesign.problem.build import build_problem
    from evodesign.problem.model_json import model_json
    from evodesign.problem.notes import notes
    from evodesign.problem.source import read_source

    built = build_problem(read_source(problem))
    show_notes(notes(built))
    if json:
        print_json(model_json(built))
        return
    for table in model_tables(built):
        console().print(table)
