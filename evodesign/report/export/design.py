"""What is exported: one evaluation of a run with its robot and postures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import msgspec

from evodesign.records import CaseDetail, CaseOutcome, Evaluation, RunHeader, hold_names, materials_of
from evodesign.report.scene_models import SceneSet
from evodesign.tree.model import Tree

__all__ = ["ExportedDesign", "design_json"]


@dataclass(frozen=True, slots=True)
class ExportedDesign:
    """A design with everything that its files tell.

    Args:
        run: name of the run, for people.
        header: of the run.
        evaluation: the design.
        scene_set: robot of the design, people and loads.
        cases: postures of those that were solved, in the problem's order.
    """

    run: str
    header: RunHeader
    evaluation: Evaluation
    scene_set: SceneSet
    cases: tuple[CaseDetail, ...]

    @property
    def people(self) -> dict[str, tuple[str, Tree]]:
        """By file name: each person's label and tree. Several people are numbered, whatever their labels."""
        people = self.scene_set.people
        if len(people) == 1:
            ((person, tree),) = people
            return {"human.urdf": (person.label, tree)}
        return {
            f"human_{number}.urdf": (person.label, tree) for number, (person, tree) in enumerate(people, 1)
        }


def design_json(
    header: RunHeader, evaluation: Evaluation, cases: tuple[CaseDetail, ...], *, on_front: bool
) -> dict[str, Any]:
    """A design as a JSON object, as the log has it; its shape is a promise."""
    assessment = evaluation.assessment
    outcome: dict[str, Any] = msgspec.to_builtins(assessment)
    materials = materials_of(header.parameters, assessment.design)
    return {
        "problem": header.problem_name,
        "id": evaluation.number,
        "generation": evaluation.generation,
        "on_front": on_front,
        "status": outcome["status"],
        "reason": outcome["reason"],
        "objectives": outcome["objectives"],
        "units": {objective.name: objective.unit for objective in header.objectives},
        "parameters": outcome["design"],
        **({"materials": materials} if materials else {}),
        "violation": outcome["violation"],
        "reach": outcome["reach"],
        "heights": [_hold(each) for each in assessment.cases],
        "postures": [_hold(each) for each in cases],
    }


def _hold(part: CaseOutcome | CaseDetail) -> dict[str, Any]:
    """A part of the log about a load held still, as it was before there were other tasks."""
    told: dict[str, Any] = msgspec.to_builtins(part)
    (instant,) = told.pop("instants", [{}])
    del told["case"]
    return {**hold_names(part.case), **told, **{key: instant[key] for key in instant if key != "time_s"}}
