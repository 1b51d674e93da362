"""Fronts as tables for people, and as JSON and CSV for programs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from evodesign.analysis.active_limits import frequent_limits, limits_json
from evodesign.analysis.choice import Choice, Chosen, Order
from evodesign.analysis.failures import causes, failures
from evodesign.analysis.gains import gains, gains_json
from evodesign.analysis.people_spread import PeopleSpread, spread_json, spread_sentence
from evodesign.cli.output import printable
from evodesign.cli.tables.table import FittedTable, designs_table
from evodesign.records import Evaluation, materials_of
from evodesign.report.csv_text import csv_text
from evodesign.runlog.run import RunLog
from evodesign.violations import HEIGHT, constraint_sentences, constraints_json, violations

TITLES = {
    Order.FIRST_OBJECTIVE: "Front of",
    Order.KNEE: "Knees of the front of",
    Order.NEAR: "Closest to the aspiration, on the front of",
    Order.DIFFERENT: "Most different designs of the front of",
}


def front_json(
    run: RunLog, choice: Choice, chosen: Chosen, spread: PeopleSpread | None = None
) -> dict[str, Any]:
    """Chosen designs as a JSON object; its shape is a promise."""
    sampled = {} if spread is None else spread.designs
    people = {} if spread is None else {"samples": spread.samples, "reference": spread.reference}
    return {
        "run": str(run.directory),
        "objectives": [objective.name for objective in run.header.objectives],
        "evaluations": len(run.evaluations),
        "front": len(chosen.front),
        "order": choice.order,
        "where": [str(condition) for condition in choice.where],
        "limits": limits_json(frequent_limits(run)),
        "gains": gains_json(gains(run)),
        **({"spread": people} if people else {}),
        "statuses": Counter(str(evaluation.assessment.status) for evaluation in run.evaluations),
        "designs": [
            {
                "id": evaluation.number,
                "objectives": evaluation.assessment.objectives,
                "parameters": evaluation.assessment.design,
                **_materials(run, evaluation),
                **_constraints(run, evaluation),
                **(
                    {"spread": spread_json(spread, evaluation.number)}
                    if spread is not None and evaluation.number in sampled
                    else {}
                ),
            }
            for evaluation in chosen.designs
        ],
    }


def _materials(run: RunLog, evaluation: Evaluation) -> dict[str, Any]:
    """The materials by parameter, under a key that only designs of materials have."""
    found = materials_of(run.header.parameters, evaluation.assessment.design)
    return {"materials": found} if found else {}


def _constraints(run: RunLog, evaluation: Evaluation) -> dict[str, Any]:
    """Constraints with value and violation, under a key that only problems with constraints have."""
    constraints = run.header.constrained
    return {"constraints": constraints_json(constraints, evaluation.assessment)} if constraints else {}


def front_csv(run: RunLog, designs: Sequence[Evaluation], spread: PeopleSpread | None = None) -> str:
    """Designs as comma-separated values: number, objectives, constraints, parameters (in full), materials.

    Where people were drawn, also in how many samples it is on the front, and mean and standard deviation of
    objectives and constraints.
    """
    objectives = [objective.name for objective in run.header.objectives]
    constraints = [constraint.name for constraint in run.header.constrained_alone]
    parameters = [parameter.name for parameter in run.header.parameters]
    made_of = [parameter for parameter in run.header.parameters if parameter.materials]
    materials = [f"{parameter.name}.material" for parameter in made_of]
    spreads = [] if spread is None else [*objectives, *constraints]
    people = ["samples_on_front"] if spread is not None else []
    people += [f"{name}.{part}" for name in spreads for part in ("mean", "deviation")]
    columns = ["design", *objectives, *constraints, *parameters, *materials, *people]
    rows = [
        [
            evaluation.number,
            *(evaluation.assessment.objectives[name] for name in objectives),
            *(evaluation.assessment.constrained.get(name) for name in constraints),
            *(evaluation.assessment.design[name] for name in parameters),
            *(parameter.material_of(evaluation.assessment.design[parameter.name]) for parameter in made_of),
            *_people_cells(spread, evaluation.number, spreads),
        ]
        for evaluation in designs
    ]
    return csv_text([columns, *rows])


def _people_cells(
    spread: PeopleSpread | None, number: int, quantities: Sequence[str]
) -> list[float | int | None]:
    """A design's cells of what spreads over people; empty ones of a design that met none."""
    if spread is None:
        return []
    own = spread.designs.get(number)
    cells: list[float | int | None] = [None if own is None else own.on_front]
    for name in quantities:
        values = None if own is None else own.quantities[name].values
        cells += [None, None] if values is None else [values.mean, values.deviation]
    return cells


def front_table(run: RunLog, choice: Choice, designs: Sequence[Evaluation]) -> FittedTable:
    """Designs with their objectives, in the given order."""
    title = f"{TITLES[choice.order]} {printable(run.header.problem_name)}"
    return designs_table(title, run.header, designs)


def front_lines(
    run: RunLog, choice: Choice, chosen: Chosen, rows: int, spread: PeopleSpread | None = None
) -> list[str]:
    """What is not in a table of so many rows, and why; what people change; then what the run holds."""
    feasible = sum(evaluation.feasible for evaluation in run.evaluations)
    counts = failures(run.evaluations)
    failed = f", failed: {causes(counts)}" if counts else ""
    gained = gains(run)
    return [
        *_remarks(run, choice, chosen, rows),
        *([] if gained is None else [gained.sentence]),
        *([] if spread is None else [spread_sentence(spread)]),
        f"{len(run.evaluations)} evaluations, {feasible} feasible, {len(chosen.front)} on the front"
        f"{_such(choice)}{failed}; the run lies in {run.directory}",
    ]


def _remarks(run: RunLog, choice: Choice, chosen: Chosen, shown: int) -> list[str]:
    """What is not in the table, and why."""
    if chosen.front:
        if shown == chosen.found:
            return []
        more = "" if choice.limit is not None else "; more with --limit, all with --csv or --json"
        kind = "knees" if choice.order is Order.KNEE else "designs"
        return [f"{shown} of {chosen.found} {kind} are shown{more}"]
    if any(evaluation.feasible for evaluation in run.evaluations):
        return [f"no feasible design{_such(choice)}"] if choice.where else []
    nearest = least_violated(run.evaluations)
    if nearest is None:
        return ["no design was evaluated to an end"] if run.evaluations else ["nothing was evaluated yet"]
    constraints, assessment = run.header.constrained, nearest.assessment
    missed = violations(constraints, assessment)[HEIGHT]
    lacks = [f"it lacks {missed:.4g} m ({assessment.reason})"] if missed else []
    why = "; ".join([*lacks, *constraint_sentences(constraints, assessment)]) or assessment.reason
    return [f"no design is feasible; design {nearest.number} comes nearest: {why}"]


def _such(choice: Choice) -> str:
    return f" with {' and '.join(map(str, choice.where))}" if choice.where else ""


def least_violated(evaluations: Sequence[Evaluation]) -> Evaluation | None:
    """The design that comes nearest to feasibility; None if no violation is known."""
    known = [each for each in evaluations if each.assessment.violation is not None]
    return min(known, key=lambda each: each.assessment.violation or 0.0, default=None)
