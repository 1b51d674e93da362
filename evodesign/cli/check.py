"""`check`: a problem as it was understood."""

from __future__ import annotations

from dataclasses import asdict

import typer

from evodesign.cli.options import BAD_INPUT, Json, ProblemPath


def check(problem: ProblemPath, json: Json = False) -> None:
    """Read a problem, show what was understood, and try whether the robot can do what is asked of it.

    Agents, load, task, and what each parameter changes; then whether the robot stands on its soles, faces the
    load, has hands that reach it, and holds it at one of the heights, and whether a search can begin. A
    height that a person, or the robot with the lengths that reach farthest, does not reach is an error.
    """
    from evodesign.cli.output import console, print_json, print_lines, show_notes
    from evodesign.cli.tables.problem import findings_table, model_tables, rules_table
    from evodesign.guess.preflight import preflight
    from evodesign.problem.build import build_problem
    from evodesign.problem.inertia_rules import rule_differences
    from evodesign.problem.model_json import model_json
    from evodesign.problem.notes import notes
    from evodesign.problem.source import read_source

    built = build_problem(read_source(problem))
    said = notes(built)
    show_notes(said)
    found, differences = preflight(built), rule_differences(built)
    if json:
        tried, rules = [asdict(each) for each in found], [asdict(each) for each in differences]
        print_json({**model_json(built), "notes": said, "inertia_rules": rules, "preflight": tried})
    else:
        rules_tables = [rules_table(differences)] if differences else []
        for table in (*model_tables(built), *rules_tables, findings_table(found)):
            console().print(table)
    faults = [each.fault for each in found if each.fault]
    print_lines(*(f"error: {fault}" for fault in faults), stderr=True)
    if faults:
        raise typer.Exit(BAD_INPUT)
