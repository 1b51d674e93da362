"""What a search ends with: a few designs of its front, what the run holds, and what to do next."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from statistics import median

from evodesign.analysis.choice import Choice, choose
from evodesign.analysis.decision_making import knees
from evodesign.analysis.front import front, to_minimise
from evodesign.analysis.people_spread import spread_of_run
from evodesign.cli.output import heading, rounded
from evodesign.cli.tables.front import front_lines, least_violated
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.records import Evaluation, Objective
from evodesign.runlog.run import RunLog
from evodesign.runlog.sampled_file import read_sampled
from evodesign.violations import bounds_text

MOST_KNEES = 5
"""Knees in the table; `evodesign front --knee` shows all."""

KNEE = "knee"

Chosen = Mapping[int, Sequence[str]]
"""Designs by number, each with what it is: a knee, or the objectives in which it is the best."""


def chosen_designs(objectives: Sequence[Objective], evaluations: Sequence[Evaluation]) -> Chosen:
    """The sharpest knees of the front, then the best in each objective, each design once."""
    found = front(objectives, evaluations)
    chosen: dict[int, list[str]] = {each.number: [KNEE] for each in knees(objectives, found)[:MOST_KNEES]}
    for objective in objectives if found else ():
        best = min(found, key=lambda each: to_minimise(objective, each.assessment.objectives[objective.name]))
        chosen.setdefault(best.number, []).append(objective.name)
    return chosen


def result_table(run: RunLog, chosen: Chosen) -> FittedTable:
    """The chosen designs, each with its number and its objectives, of which the best are marked."""
    objectives = run.header.objectives
    title = f"Knees of the front of {run.header.problem_name}, and the best in each objective"
    others = run.header.constrained_alone
    bounds = [f"{each.name} [{each.unit}], {bounds_text(each)}" for each in others]
    columns = [*numbers("design"), *names(""), *numbers(*map(heading, objectives), *bounds)]
    table = titled(title, columns, caption="*: the best value of the front")
    by_number = {each.number: each for each in run.evaluations}
    for number, reasons in chosen.items():
        assessment = by_number[number].assessment
        values = assessment.objectives
        table.add_row(
            number,
            KNEE if KNEE in reasons else "",
            *(f"{'* ' * (each.name in reasons)}{rounded(values[each.name])}" for each in objectives),
            *(assessment.constrained.get(each.name) for each in others),
        )
    return table


def result_lines(run: RunLog, chosen: Chosen) -> list[str]:
    """What the run holds; where nothing is feasible, what comes nearest and what may help."""
    whole = Choice()
    found = choose(run.header.objectives, run.evaluations, whole)
    spread = spread_of_run(run, read_sampled(run)[0])
    lines = [*front_lines(run, whole, found, len(found.front), spread), *_gradient_lines(run)]
    if not chosen and run.evaluations:
        lines.append(
            "what may help: lower heights in [task], wider bounds in [[design.length]], or more evaluations"
        )
    return lines


def _gradient_lines(run: RunLog) -> list[str]:
    """What gradients took of the time of the evaluations that have them."""
    costs = [each.gradient_seconds for each in run.evaluations if each.gradient_seconds]
    if not costs:
        return []
    others = [each.seconds - each.gradient_seconds for each in run.evaluations if each.gradient_seconds]
    much, share = 1e3 * median(costs), median(costs) / max(median(others), 1e-9)
    return [f"gradients took {much:.1f} ms a design, {share:.2g} of the rest of its evaluation (medians)"]


def next_commands(run: RunLog, chosen: Chosen) -> tuple[str, str, str]:
    """Three commands that go on from here: with a design of the front, or with a larger budget."""
    place = shlex.quote(str(run.directory))
    report = f"evodesign report {place}"
    if chosen:
        return report, f"evodesign show {place} {next(iter(chosen))}", f"evodesign front {place}"
    nearest = least_violated(run.evaluations)
    look = (
        f"evodesign watch {place} --once" if nearest is None else f"evodesign show {place} {nearest.number}"
    )
    return report, look, f"evodesign resume {place} --evaluations {2 * run.header.budget}"
