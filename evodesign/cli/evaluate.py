"""`evaluate`: one design in full."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from evodesign.cli import options
from evodesign.errors import InputError
from evodesign.files import make_folder

if TYPE_CHECKING:
    from evodesign.analysis.people_spread import PeopleSpread
    from evodesign.problem.build import DesignProblem
    from evodesign.quantities.design_result import DesignResult

UNSCALED = "unscaled"


def evaluate(
    problem: options.ProblemPath,
    design: options.DesignsFile = None,
    name: options.DesignName = None,
    symmetry: options.SymmetryName = None,
    jobs: options.Jobs = options.CORES,
    json: options.Json = False,
    plot: options.Plot = None,
) -> None:
    """One design in full: reach, postures, torques, wrenches, residuals. Exit code 5: no case is solved."""
    from evodesign.analysis.people_spread import spread_json
    from evodesign.cli.output import console, print_json, show_notes
    from evodesign.cli.progress import precompute_progress
    from evodesign.cli.tables.design import design_tables
    from evodesign.cli.tables.spread import quantities_table
    from evodesign.evaluation.clearance import overlaps, solved_distances
    from evodesign.evaluation.evaluation_json import evaluation_json
    from evodesign.evaluation.factory import evaluator_of
    from evodesign.evaluation.sensitivities import Sensitivities
    from evodesign.problem.build import build_problem
    from evodesign.problem.notes import notes
    from evodesign.problem.source import read_source

    built = build_problem(read_source(problem, symmetry))
    show_notes(notes(built))
    chosen, values = chosen_design(built, design, name)
    if plot is not None:
        make_folder(plot, "--plot")
    with precompute_progress() as progress:
        evaluator = evaluator_of(built, jobs, progress)
    result = evaluator.solve(values)
    assessment = evaluator.assessment(values, result)
    if plot is not None:
        _write_figures(f"{built.name}, {chosen}", result, plot)
    sensitivities = Sensitivities(built, evaluator.known).at(values, result).sensitivities()
    solved = evaluator.details(result)
    spread = _spread(built, values, jobs) if built.samples else None
    if json:
        told = evaluation_json(built, values, result, assessment, sensitivities, solved)
        print_json(told if spread is None else {**told, "spread": spread_json(spread, 0)})
    else:
        for table in design_tables(built, chosen, result, assessment, sensitivities, solved):
            console().print(table)
        if spread is not None:
            means = {**assessment.objectives, **assessment.constrained}
            table = quantities_table(
                spread, 0, built.objectives, built.constraints, means, "the unscaled robot"
            )
            table.title = f"beside {built.samples} samples of people"
            console().print(table)
        show_notes(overlaps(solved_distances(result).items()))
    if not any(case.solved for case in result.cases):
        raise typer.Exit(options.NOTHING_SOLVED)


def _spread(built: DesignProblem, values: tuple[float, ...], jobs: int) -> PeopleSpread:
    """Of a design over samples of people, compared with the unscaled robot if it is another one."""
    from evodesign.analysis.people_spread import people_spread
    from evodesign.cli.output import show_notes
    from evodesign.cli.progress import precompute_progress
    from evodesign.evaluation.sampled_designs import sampled_beside

    designs = tuple(dict.fromkeys((values, built.space.unscaled(built.scene.designed_tree))))
    show_notes([f"{built.samples} samples of people: {built.samples * len(designs)} further evaluations"])
    with precompute_progress() as progress:
        sampled = sampled_beside(built, designs, jobs, progress)
    return people_spread(built.objectives, built.constraints, sampled, 1)


def _write_figures(name: str, result: DesignResult, directory: Path) -> None:
    """Write figures of a result to an existing directory, and say where."""
    from evodesign.cli.output import show_notes
    from evodesign.evaluation.evaluate import detail_of
    from evodesign.report.figures.design import write_design_figures  # matplotlib takes its time to load
    from evodesign.report.scene_models import SceneSet

    cases = [detail_of(case) for case in result.cases if case.solved]
    written = write_design_figures(name, SceneSet.of(result.scenes, result.tree), cases, directory)
    show_notes(f"written: {path}" for path in written)


def chosen_design(
    problem: DesignProblem, file: Path | None, name: str | None
) -> tuple[str, tuple[float, ...]]:
    """Name and parameter values of the design that the options ask for; notes say which are beyond bounds."""
    from evodesign.cli.output import show_notes
    from evodesign.problem.designs import beyond_bounds

    chosen, values = _named_design(problem, file, name)
    show_notes(beyond_bounds([each.record for each in problem.space.parameters], values).values())
    return chosen, values


def _named_design(
    problem: DesignProblem, file: Path | None, name: str | None
) -> tuple[str, tuple[float, ...]]:
    """The design of a name in a file; without a file the unscaled robot."""
    from evodesign.problem.designs import read_designs
    from evodesign.problem.named_files import read_text
    from evodesign.problem.unknown_names import refuse_unlisted

    tree = problem.scene.designed_tree
    if file is None:
        if name is not None and name != UNSCALED:
            raise InputError("--name", "", "a --design FILE that holds it", "no file")
        return UNSCALED, problem.space.unscaled(tree)
    designs = read_designs(read_text(file, "--design", ""), str(file), problem.space, tree)
    if name is None and len(designs) == 1:
        name = next(iter(designs))
    wanted = f"one of the designs {', '.join(designs)} of '{file}'"
    if name is None:
        raise InputError("--name", "", wanted, "nothing")
    refuse_unlisted("--name", "", name, designs, wanted)
    return name, designs[name]
