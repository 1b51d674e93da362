"""Whether a run's records agree with each other: everything in it that can be worked out a second time."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import groupby

from evodesign.analysis.run_state import RunState
from evodesign.records import Evaluation, Generation, RunHeader, design_of
from evodesign.runlog.gaps import consecutive, listed, missing, record_gaps
from evodesign.runlog.run import RunLog
from evodesign.violations import missed_height, total_violation

TOLERANCE = 1e-9
"""Relative difference of a hypervolume that rounding on another processor may cause."""


def audit(run: RunLog) -> list[str]:
    """A sentence for each contradiction; none in a sound run."""
    gaps = record_gaps(run.header, run.evaluations, run.generations, run.fronts)
    return [*_evaluations(run), *gaps, *_generations(run), *_details(run)]


def _evaluations(run: RunLog) -> Iterator[str]:
    for evaluation in run.evaluations:
        if fault := _fault(run.header, evaluation):
            yield f"evaluation {evaluation.number}: {fault}"


def _fault(header: RunHeader, evaluation: Evaluation) -> str:
    """What is wrong with an evaluation by itself; empty if nothing is."""
    assessment = evaluation.assessment
    if len(evaluation.genome) != len(header.parameters):
        return f"wanted {len(header.parameters)} coordinates, found {len(evaluation.genome)}"
    if not all(0.0 <= coordinate <= 1.0 for coordinate in evaluation.genome):
        return "its genome lies outside the unit cube"
    if assessment.design != design_of(header.parameters, evaluation.genome):
        return "its design is not that of its genome"
    strange = set(assessment.objectives) - {objective.name for objective in header.objectives}
    if strange:
        return f"it has unknown objectives: {', '.join(sorted(strange))}"
    constraints = header.constrained
    unknown = set(assessment.constrained) - {constraint.name for constraint in constraints}
    if unknown:
        return f"it has values of unknown constraints: {', '.join(sorted(unknown))}"
    if assessment.violation is not None and assessment.violation < 0.0:
        return f"its violation is negative: {assessment.violation:g}"
    missed = missed_height(assessment.reach, assessment.cases)
    if constraints and assessment.violation != total_violation(constraints, assessment.constrained, missed):
        return "its violation is not that of its values"
    return ""


def _generations(run: RunLog) -> Iterator[str]:
    """Records of generations and fronts that contradict the evaluations."""
    states = {state.number: state for state in run.generations}
    fronts = {front.generation: front for front in run.fronts}
    run_state = RunState(run.header.objectives)
    shown = 0
    for number, group in groupby(run.evaluations, key=lambda evaluation: evaluation.generation):
        born = list(group)
        run_state.add(born)
        shown += len(born)
        if number in states and states[number].evaluations != shown:
            yield (
                f"generation {number}: its record counts {states[number].evaluations} evaluations, "
                f"the log holds {shown}; later ones were not looked at"
            )
            return
        if number in states:
            yield from _differing(states[number], run_state.generation(number, born, states[number].seconds))
        if number in fronts and number in states and fronts[number] != run_state.front(number):
            yield f"generation {number}: its front is not that of the evaluations"


def _differing(logged: Generation, found: Generation) -> Iterator[str]:
    for field in ("feasible_share", "reference", "best"):
        if getattr(logged, field) != getattr(found, field):
            yield f"generation {logged.number}: its {field.replace('_', ' ')} is not that of the evaluations"
    one, other = logged.hypervolume, found.hypervolume
    if (one is None) != (other is None) or (
        one is not None and other is not None and not math.isclose(one, other, rel_tol=TOLERANCE)
    ):
        yield f"generation {logged.number}: its hypervolume is not that of the evaluations"


def _details(run: RunLog) -> Iterator[str]:
    """Postures without a design, and designs of a front without postures."""
    known = {evaluation.number for evaluation in run.evaluations}
    detailed = {detail.evaluation for detail in run.details}
    members = {number for front in run.fronts for number in front.evaluations}
    bare = sorted(members - detailed)
    if detailed and bare:
        yield f"no postures for members of a front: {listed(consecutive(bare))}"
    lost = sorted(number for number in detailed - known if number < max(known, default=0))
    if lost:
        yield f"postures without an evaluation: {listed(consecutive(lost))}"


def losses(run: RunLog) -> list[str]:
    """A sentence for each kind of record that is missing; none if nothing is known to be."""
    known = {evaluation.number for evaluation in run.evaluations}
    numbered = [
        *known,
        *(state.evaluations - 1 for state in run.generations),
        *(number for front in run.fronts for number in front.evaluations),
    ]
    concluded = max((evaluation.generation for evaluation in run.evaluations), default=0)
    members = {number for front in run.fronts for number in front.evaluations}
    detailed = {detail.evaluation for detail in run.details}
    lost = {
        "evaluations": missing(known, 1 + max(numbered, default=-1)),
        "states of generations": missing((state.number for state in run.generations), concluded),
        "fronts of generations": missing((front.generation for front in run.fronts), concluded),
        "postures of designs": consecutive(members - detailed) if detailed else [],
    }
    return [f"missing {what}: {listed(ranges)}" for what, ranges in lost.items() if ranges]
