"""`evaluate` and `check`: one design in full, one problem as it was understood."""

from __future__ import annotations

from pathlib import Path

from evodesign.cli.making import making
from evodesign.cli.output import console, print_json, show_notes
from evodesign.cli.tables.design import asked_table, assessment_tables, sensitivity_table
from evodesign.cli.tables.problem import model_tables
from evodesign.errors import InputError, nearest_name
from evodesign.problem.build import Problem, build_problem
from evodesign.problem.designs import read_designs
from evodesign.problem.evaluation_json import evaluation_json
from evodesign.problem.factory import evaluator_of
from evodesign.problem.model_json import model_json
from evodesign.problem.notes import notes
from evodesign.problem.sensitivities import Sensitivities
from evodesign.problem.source import read_source, read_text

__all__ = ["check_problem", "evaluate_design"]

UNSCALED = "unscaled"


def evaluate_design(
    problem: Path, design: Path | None, name: str | None, symmetry: str | None, jobs: int, json: bool
) -> None:
    """Solve one design and print everything about it."""
    built = build_problem(read_source(problem, symmetry))
    chosen, values = _chosen(built, design, name)
    with making() as progress:
        evaluator = evaluator_of(built, jobs, progress)
    result = evaluator.solve(values)
    assessment = evaluator.assessment(values, result)
    moves = Sensitivities(built, evaluator.known).at(values, result).sensitivities()
    if json:
        print_json(evaluation_json(built, values, result, assessment, moves))
        return
    tables = assessment_tables(built, chosen, result, assessment)
    asked = [asked_table(result)] if any(height.solved for height in result.heights) else []
    for table in (*tables, *asked, *([sensitivity_table(built, moves)] if moves else [])):
        console().print(table)


def check_problem(problem: Path, json: bool) -> None:
    """Read a problem and print what was understood."""
    built = build_problem(read_source(problem))
    show_notes(notes(built))
    if json:
        print_json(model_json(built))
        return
    for table in model_tables(built):
        console().print(table)


def _chosen(problem: Problem, file: Path | None, name: str | None) -> tuple[str, tuple[float, ...]]:
    """Name and parameter values of the design that the options ask for."""
    tree = problem.scene.robot.tree
    if file is None:
        if name is not None and name != UNSCALED:
            raise InputError("--name", "", "a --design FILE that holds it", "no file")
        return UNSCALED, problem.space.unscaled(tree)
    designs = read_designs(read_text(file, "--design", ""), str(file), problem.space, tree)
    if name is None and len(designs) == 1:
        name = next(iter(designs))
    if name is None:
        raise InputError("--name", "", f"one of the designs {', '.join(designs)} of '{file}'", "nothing")
    if name not in designs:
        wanted = f"one of the designs {', '.join(designs)} of '{file}'"
        raise InputError("--name", "", wanted, f"'{name}'{nearest_name(name, designs)}")
    return name, designs[name]
